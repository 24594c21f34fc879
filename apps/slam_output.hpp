// The files that `phasescan slam` leaves in its folder.
#pragma once

#include <string>
#include <vector>

#include "io/file.hpp"
#include "map/glass.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "slam/input_check.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::app {

/// What a run knows beside what Slam holds.
struct SlamRun {
  std::string log;
  std::string format;
  std::string odometry_assumed;
  bool odometry_used = false;
  bool complete = true;  ///< false: stopped by the user
  bool times = true;
  bool glass_blocks = true;        ///< sure glass is occupied in map.pgm
  std::vector<float> cpu_ms;       ///< tracker's thread, per scan
  std::vector<float> tracking_ms;  ///< the same without loops and graph
  std::vector<float> wall_ms;
  std::vector<float> overlap;
  std::size_t tracked = 0, searched = 0, caught = 0, new_segments = 0, usable = 0;
  double total_cpu_s = 0.0, total_wall_s = 0.0;
  std::map<std::string, std::size_t> damages;  ///< of the reader, by kind
  const InputCheck* check = nullptr;
  Pose2 T_base_laser;    ///< of the first scan
  bool flipped = false;  ///< that laser is mounted upside down
};

/// The map as a robot should read it, and what is glass or black in it.
struct FinishedMap {
  TrinaryMap map;
  std::vector<GlassPane> panes;
};
/// @param glass_blocks  sure panes are occupied
FinishedMap finished_map(const Slam& slam, bool glass_blocks);

/// trajectory.tum, map.pgm, map.yaml, map.png, graph.g2o, report.html, summary.json and, with times, timing.json:
/// written, not yet in place. Without times, timing.json of an earlier run goes when they are. @throws SystemError
FileSet slam_output(const std::string& folder, const Slam& slam, const SlamRun& run);

}  // namespace phasescan::app
