/// What a node says, to whom it runs in: rclcpp, DDS, a test.
#pragma once

#include <string>

#include "ros2/messages.hpp"

namespace phasescan::ros2 {

/// Called from within the node's functions, on the caller's thread; `map` from the thread that draws maps, too.
class NodeOutputs {
 public:
  virtual ~NodeOutputs() = default;
  virtual void transforms(const TFMessage&) {}
  virtual void pose(const PoseWithCovarianceStamped&) {}  ///< "pose" of SLAM, "amcl_pose" of localisation
  virtual void map(const OccupancyGrid&) {}               ///< its `info` is map_metadata
  virtual void path(const Path&) {}
  virtual void particles(const ParticleCloud&) {}
  virtual void status(const String&) {}
  virtual void diagnostics(const DiagnosticArray&) {}
};

/// States of a managed node of ROS 2 that last.
enum class Lifecycle { kUnconfigured, kInactive, kActive };

/// Answer of a service: done, or why not.
struct Answer {
  bool done = true;
  std::string why;
};

}  // namespace phasescan::ros2
