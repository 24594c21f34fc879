/// MCAP files with ROS 2 messages: what Foxglove, Lichtblick and rosbag2 open.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// An occupancy grid as nav_msgs has it.
struct McapGrid {
  double resolution_m = 0.0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose2 T_map_origin;                  ///< of the grid's lower left corner
  std::span<const std::int8_t> cells;  ///< rows from the bottom, width * height: -1 unknown, 0 free .. 100 occupied
};

/// Writes chunks of about 1 MiB packed with zstd, with checksums, indexes and a summary. Holds one chunk in memory.
/// The file appears whole with `close`, or not at all.
class McapWriter {
 public:
  /// @throws as AtomicFile.
  explicit McapWriter(const std::string& path);
  ~McapWriter();
  McapWriter(McapWriter&&) noexcept;
  McapWriter& operator=(McapWriter&&) noexcept;

  /// @name Messages. The stamp is the log time as well; one before 1970 is logged at 0.
  /// @throws SystemError where the disk is full.
  /// @{

  /// sensor_msgs/LaserScan. `scan_seconds`: time of a turn, 0 = unknown.
  /// @throws std::invalid_argument for beams at uneven angles, which the message cannot say.
  void scan(const std::string& topic, const std::string& frame, const Scan& scan, double scan_seconds = 0.0);
  /// nav_msgs/Odometry, T_frame_child; twist and covariances are 0 (unknown).
  void odometry(const std::string& topic, Stamp stamp, const std::string& frame, const std::string& child,
                const Pose2& pose);
  /// tf2_msgs/TFMessage with one transform on /tf; `flipped`: the child lies upside down.
  void transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                 bool flipped = false);
  /// The same on /tf_static.
  void static_transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                        bool flipped = false);
  /// nav_msgs/Path.
  void path(const std::string& topic, Stamp stamp, const std::string& frame,
            std::span<const std::pair<Stamp, Pose2>> poses);
  /// nav_msgs/OccupancyGrid. @throws std::invalid_argument where the cells are not width * height.
  void grid(const std::string& topic, Stamp stamp, const std::string& frame, const McapGrid& grid);
  /// @}

  /// Writes the summary and puts the file in its place. @throws SystemError.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
