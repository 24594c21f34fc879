// A live run as ROS 2 messages: what a recording holds and what Foxglove is sent.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/laser_names.hpp"
#include "phasescan/live/live.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::live {

/// A message as CDR.
struct RosMessage {
  std::string topic, type;
  Stamp stamp = 0;
  std::vector<std::uint8_t> bytes;
};

/// A topic that every run has. `stays`: who comes later is sent the last message.
struct RosTopic {
  std::string_view topic, type;
  bool stays;
};
std::span<const RosTopic> ros_topics();

/// Frames: map -> odom -> base_link -> laser (REP 105).
class RosView {
 public:
  /// The scan, /tf, /pose where it is tracked, /status, /diagnostics; /tf_static where a laser is new.
  std::vector<RosMessage> of(const LiveUpdate& live);

 private:
  LaserNames names_;
};

/// /map.
RosMessage map_message(Stamp stamp, const TrinaryMap& map);
/// /path: the keyframes as the map has them, at most 2000 of them, and the pose now.
RosMessage path_message(const LiveUpdate& live);

}  // namespace phasescan::live
