/// The report of a SLAM run: one HTML file with the map, the way, the loops, and how the run went.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "phasescan/slam/slam.hpp"
#include "report/map_viewer.hpp"

namespace phasescan {

/// Why a run is not simply good. What judges a run fills these.
struct VerdictReason {
  std::string kind;  ///< as in summary.json
  std::size_t count = 0;
  Stamp first_stamp = 0;
  std::string text;            ///< in words
  std::optional<double> x, y;  ///< where on the map [m]
};

/// What the report shows.
struct SlamReport {
  std::string log_name;
  const SlamResult* result = nullptr;
  std::span<const float> overlap;                          ///< per scan, 0..1
  std::span<const float> cpu_ms;                           ///< per scan; empty: no section on time
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value, as they stand in the summary
  std::vector<std::string> warnings;
  const ShownScans* shown = nullptr;   ///< scans to look through; none: no viewer
  bool complete = true;                ///< false: stopped before the end of the log
  std::string verdict;                 ///< in words; empty: none was made
  std::vector<VerdictReason> reasons;  ///< strongest first
};

/// @pre report.result is set
std::string format_slam_report(const SlamReport& report);

/// Base64 of bytes, for pictures inside a page.
std::string base64(std::string_view bytes);

}  // namespace phasescan
