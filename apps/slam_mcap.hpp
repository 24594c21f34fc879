// The MCAP that `phasescan slam --mcap` leaves: scans, frames, path and map for Foxglove or Lichtblick.
#pragma once

#include <optional>
#include <string>

#include "io/laser_names.hpp"
#include "io/mcap_writer.hpp"
#include "phasescan/io/log.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::app {

/// Takes the scans while the log is read, so that it is read once, and the rest when the run is finished.
class SlamRecording {
 public:
  /// @throws SystemError
  explicit SlamRecording(const std::string& path) : file_(path) {}

  /// The next scan, as the run takes it.
  void add(const LogEntry& entry);
  /// /tf with map -> odom -> base_link for every scan, and at the first stamp, to be seen from the start, /map
  /// (OccupancyGrid) and /path. The file is in place then. @throws SystemError
  void finish(const SlamResult& result);

 private:
  McapWriter file_;
  LaserNames names_;
  std::optional<Stamp> start_;
};

}  // namespace phasescan::app
