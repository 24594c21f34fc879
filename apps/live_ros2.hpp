// `live` on a network of ROS 2: --port ros2:/TOPIC and --ros2. Without CycloneDDS each says that it is not built in.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "phasescan/live/live.hpp"

namespace phasescan::app {

class LiveRos2 final : public live::LiveSink {
 public:
  /// Whether a port is a topic of ROS 2.
  static bool is_topic(const std::string& port) { return port.starts_with("ros2:"); }

  /// @param wanted  whether anything of ROS 2 is asked for; else nothing is opened
  /// @throws std::invalid_argument for variables of ROS 2 that are wrong, or where this build has no DDS; SystemError
  explicit LiveRos2(bool wanted);
  ~LiveRos2() override;

  /// @throws std::invalid_argument for a name that is no topic
  std::unique_ptr<live::LiveSource> open(const std::string& port);
  /// From now on `take` publishes. @param known_map  poses go to amcl_pose too, as of a node that localises
  /// @param set_pose  what becomes of a pose on initialpose
  void publish(const OccupancyOptions& map, bool known_map,
               std::function<void(const Pose2&, const Eigen::Matrix3d&)> set_pose);
  void take(const live::LiveUpdate& update) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan::app
