// The files that `phasescan slam` leaves in its folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/file.hpp"
#include "phasescan/slam/slam.hpp"
#include "report/map_viewer.hpp"

namespace phasescan::app {

/// What a run knows beside its result.
struct SlamRun {
  std::string log;
  std::string format;
  std::string odometry_assumed;
  bool odometry_used = false;
  bool complete = true;  ///< false: stopped by the user
  bool times = true;
  bool glass_blocks = true;        ///< sure glass is occupied in map.pgm
  bool deskew_asked = true;        ///< by the options
  std::vector<float> cpu_ms;       ///< tracker's thread, per scan
  std::vector<float> tracking_ms;  ///< the same without loops and graph
  std::vector<float> wall_ms;
  std::vector<float> overlap;
  ShownScans shown;
  std::size_t tracked = 0, searched = 0, caught = 0, new_segments = 0, usable = 0;
  double total_cpu_s = 0.0, total_wall_s = 0.0;
  std::map<std::string, std::size_t> damages;     ///< of the reader, by kind
  std::map<std::string, std::string> first_seen;  ///< of each oddity of the scans: "FILE:LINE: what"
  Pose2 T_base_laser;                             ///< of the first scan
  bool flipped = false;                           ///< that laser is mounted upside down
};

/// trajectory.tum, scans.jsonl, map.pgm, map.yaml, map.png, graph.g2o, report.html, summary.json and, with times,
/// timing.json: written, not yet in place. Without times, timing.json of an earlier run goes when they are.
/// @throws SystemError
FileSet slam_output(const std::string& folder, const SlamResult& result, const SlamRun& run);

/// Length of a way [m].
double path_length(const std::vector<Pose2>& poses);

}  // namespace phasescan::app
