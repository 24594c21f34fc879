/// ROS messages as CDR, with the definitions a reader needs to understand them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/ros_messages.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan::ros {

/// nav_msgs/OccupancyGrid: rows from the lower left, -1 unknown, 0 free .. 100 occupied.
struct OccupancyGrid {
  Header header;
  float resolution_m = 0.0F;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose2 T_map_origin;  ///< of the lower left corner of cell (0, 0)
  std::span<const std::int8_t> cells;
};

/// nav_msgs/Path.
struct PathPoint {
  Stamp stamp = 0;
  Pose2 pose;
};
struct Path {
  Header header;
  std::span<const PathPoint> points;
};

/// std_msgs/String.
struct Text {
  std::string data;
};

/// diagnostic_msgs/DiagnosticArray with one status.
struct Diagnostics {
  enum class Level : std::uint8_t { kOk, kWarn, kError };
  Header header;
  Level level = Level::kOk;
  std::string name, message, hardware_id;
  std::vector<std::pair<std::string, std::string>> values;
};

/// A planar pose in space; upside down turns it by half a turn about its own x axis.
Pose3 spatial(const Pose2& pose, bool flipped = false);

/// @name Encoders: little-endian CDR with its 4 bytes of encapsulation, appended to `out`, which must be empty.
/// @{
void encode(const LaserScan& message, ByteWriter& out);
void encode(const Odometry& message, ByteWriter& out);
void encode(const std::vector<Transform>& message, ByteWriter& out);
void encode(const OccupancyGrid& message, ByteWriter& out);
void encode(const Path& message, ByteWriter& out);
void encode(const PoseEstimate& message, ByteWriter& out);
void encode(const Text& message, ByteWriter& out);
void encode(const Diagnostics& message, ByteWriter& out);
/// @}

/// The definition of a message type in the form "ros2msg", with those of all types it is made of.
/// @throws std::invalid_argument for a type that none of them is.
std::string message_definition(std::string_view type);

}  // namespace phasescan::ros
