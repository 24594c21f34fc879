/// The report of a SLAM run: one HTML file with the map, the way, the loops, and how the run went.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "graph/pose_graph.hpp"
#include "map/glass.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan {

/// What the report shows.
struct SlamReport {
  std::string log_name;
  const TrinaryMap* map = nullptr;
  std::span<const Pose2> trajectory;        ///< with loops
  std::span<const Pose2> odometry;          ///< laser odometry alone, same length
  std::span<const char> on_map;             ///< per scan: 0 where it is on no part of the map; empty: all are
  std::span<const char> node_on_map;        ///< the same of the graph's nodes
  std::span<const GlassPane> glass;         ///< drawn over the map
  const PoseGraph* graph = nullptr;         ///< its robust edges are the loops
  std::vector<std::pair<int, int>> undone;  ///< keyframes of loops that were taken out again
  std::span<const float> overlap;           ///< per scan, 0..1
  std::span<const float> cpu_ms;            ///< per scan; empty: no section on time
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, as they stand in the summary
  std::vector<std::string> warnings;
};

std::string format_slam_report(const SlamReport& report);

/// Base64 of bytes, for pictures inside a page.
std::string base64(std::string_view bytes);

}  // namespace phasescan
