/// A live run on a network of ROS 2: what its scans come from and what it says share one participant.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "dds/participant.hpp"
#include "phasescan/live/live.hpp"
#include "ros2/diagnostics.hpp"

namespace phasescan::dds {

struct LiveLink {
  explicit LiveLink(const Network& network) : participant(network) {}

  Participant participant;
  std::mutex mutex;  ///< of all that follows: source and publisher are of different threads
  ros2::Diagnostics told{"phasescan"};
  std::string base_frame = "base_link", odom_frame = "odom", map_frame = "map";
  bool scans_from_ros = false;  ///< else they are published too
};

/// Scans of topics, as `ros2:/scan` or `ros2:/front,/back` names them, with mountings and odometry of /tf. Where no
/// transform leads from a laser to base_link or base_footprint for two seconds (seven where somebody publishes
/// /tf_static), it is taken to sit at the base.
/// @throws std::invalid_argument for names that ROS 2 does not allow
std::unique_ptr<live::LiveSource> open_ros2(std::shared_ptr<LiveLink> link, const std::string& port);

}  // namespace phasescan::dds
