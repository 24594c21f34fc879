/// Where frames sit on one another: the transforms of /tf and /tf_static, and where a laser is mounted.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/ros_messages.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan::ros {

/// Frame names are the same with and without the leading slash of old ROS.
std::string plain_frame(std::string_view name);

/// The part of a pose that lies in the plane: x, y and the direction of the x axis.
Pose2 planar(const Pose3& pose);

/// Where a laser sits on its robot.
struct Mounting {
  Pose2 T_base_laser;
  bool flipped = false;   ///< z points down
  double tilt_rad = 0.0;  ///< angle between the scan plane and the base's plane
};

/// The latest transform of every child frame. Holds at most 4096 frames, whatever a file says.
class TransformTree {
 public:
  void add(const Transform& transform);
  bool empty() const { return parents_.empty(); }

  /// T_a_b over the nearest common ancestor, or nothing where they are not joined.
  std::optional<Pose3> find(const std::string& a, const std::string& b) const;
  /// The laser on its robot: on `base` where that is named and joined to it, else on base_link or base_footprint.
  std::optional<Mounting> mounting(const std::string& base, const std::string& laser) const;

 private:
  struct Edge {
    std::string parent;
    Pose3 pose;
  };
  std::map<std::string, Edge> parents_;
};

}  // namespace phasescan::ros
