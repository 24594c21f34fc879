/// foxglove.LaserScan, as JSON and as protobuf.
#pragma once

#include "io/ros_messages.hpp"

namespace phasescan::ros {

/// As a LaserScan whose increment leads from start_angle to end_angle. The scan's own pose in its frame is not used.
/// By hand: protobuf's library would be one more dependency of every program that reads logs, for one message of six
/// fields. @throws DecodeError where the bytes do not hold the message they should.
void decode_foxglove(Wire wire, Bytes data, LaserScan& out);

}  // namespace phasescan::ros
