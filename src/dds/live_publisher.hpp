/// What a live run says on a network of ROS 2: transforms, pose, map, path, status, diagnostics, and its scans.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "dds/live_link.hpp"
#include "ros2/first_map.hpp"
#include "ros2/frames.hpp"
#include "ros2/outputs.hpp"

namespace phasescan::dds {

class LivePublisher {
 public:
  /// @param known_map  poses go to amcl_pose too, as of a node that localises
  /// @param set_pose  a pose that somebody published on initialpose, by the thread of `take`
  LivePublisher(std::shared_ptr<LiveLink> link, const OccupancyOptions& map, bool known_map,
                std::function<void(const Pose2&, const Eigen::Matrix3d&)> set_pose);
  ~LivePublisher();

  /// Publishes what a scan brought. By one thread.
  void take(const live::LiveUpdate& live);

 private:
  void publish_frames(const live::LiveUpdate& live);
  void publish_scan(const RangeMeasurement& measurement);
  void publish_map(const live::LiveUpdate& live);
  void publish_diagnostics(const live::LiveUpdate& live);
  void take_poses();

  struct Topics;
  std::shared_ptr<LiveLink> link_;
  std::function<void(const Pose2&, const Eigen::Matrix3d&)> set_pose_;
  std::shared_ptr<Topics> topics_;
  ros2::MapToOdom map_to_odom_;
  std::unique_ptr<ros2::FirstMap> first_map_;
  std::shared_ptr<std::atomic<bool>> drawing_now_ = std::make_shared<std::atomic<bool>>(false);
  std::optional<Stamp> last_map_, last_diagnostics_;
  std::optional<std::uint64_t> last_version_;
  std::map<LaserId, Pose2> mounted_;
  std::string last_status_;
  std::uint64_t scans_ = 0;
  ThreadExecutor drawing_;  // its destructor waits for the map that is drawn
};

}  // namespace phasescan::dds
