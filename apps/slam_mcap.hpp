// The MCAP that `phasescan slam --mcap` leaves: scans, frames, path and map for Foxglove or Lichtblick.
#pragma once

#include <string>

#include "phasescan/io/log.hpp"
#include "io/mcap_writer.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::app {

/// Reads the log once more and writes every scan that has a pose, /tf with map -> odom -> base_link, /tf_static with
/// the lasers, and at the first stamp, to be seen from the start, /map (OccupancyGrid) and /path.
/// @throws SystemError, InputError
void write_slam_mcap(McapWriter& file, const std::string& log, const LogOptions& options, const Slam& slam,
                     bool glass_blocks);

}  // namespace phasescan::app
