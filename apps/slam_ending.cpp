#include "slam_ending.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "commands.hpp"
#include "progress.hpp"
#include "slam_summary.hpp"

namespace phasescan::app {
namespace {

std::string scans_text(const SlamResult& result, const SlamRun& run) {
  std::string text = std::to_string(result.scans.size());
  const std::size_t unmatched = run.usable - std::min(run.usable, run.tracked), off_map = result.scans_off_the_map(),
                    bad = result.scans_left_out() - off_map;
  if (unmatched > 0) text += fmt::format(", {} not matched", unmatched);
  if (off_map > 0) text += fmt::format(", {} not on the map", off_map);
  if (bad > 0) text += fmt::format(", {} left out", bad);
  if (unmatched + off_map + bad == 0) text += ", all on the map";
  return text + (run.complete ? "" : " (stopped before the end of the log)");
}

/// Size of what is known of the map: its image has a margin.
std::string map_text(const TrinaryMap& map) {
  int left = map.width, right = -1, low = map.height, high = -1;
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const auto cell =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(col);
      if (map.cells[cell] == CellState::kUnknown) continue;
      left = std::min(left, col), right = std::max(right, col);
      low = std::min(low, row), high = std::max(high, row);
    }
  }
  if (right < left) return "nothing in it";
  return fmt::format("{} x {}, cells of {} cm", metres_text((right - left + 1) * map.resolution_m),
                     metres_text((high - low + 1) * map.resolution_m), 100.0 * map.resolution_m);
}

}  // namespace

bool warn_of_result(const SlamResult& result, const SlamRun& run, const std::string& folder) {
  bool damaged = false;
  for (const auto& [kind, oddity] : result.oddities) {
    damaged |= oddity.damage;
    const std::string times = " (" + std::to_string(oddity.count) + " times: " + kind + ")";
    const auto first = run.first_seen.find(kind);
    warn((first == run.first_seen.end() ? run.log + ": " + oddity.what : first->second) +
         (oddity.count > 1 ? times : ""));
  }
  if (!result.parts.empty()) {
    // Of kind "pieces" among the reasons of a verdict.
    warn(run.log + ": nothing ties all drives to each other; they are in " + std::to_string(result.parts.size()) +
         " parts, " + folder + "/1 to " + folder + "/" + std::to_string(result.parts.size()));
  } else if (const std::size_t left_out = result.scans_off_the_map(); left_out > 0) {
    warn(run.log + ": the map is in " + std::to_string(result.pieces) + " pieces that nothing ties; " +
         std::to_string(left_out) + " scans are not on it");
  }
  if (!result.deskewed && run.deskew_asked) {
    warn(run.log +
         ": turns show that the beams of a scan are of one time, whatever time_increment says; motion is not "
         "taken out of the scans");
  }
  return damaged;
}

int report_verdict(const SlamResult& result, const SlamRun& run, int code) {
  const Verdict verdict = result.verdict.verdict;
  if (verdict == Verdict::kGood) return code;
  warn(run.log + ": " + verdict_text(result));
  return verdict == Verdict::kFailed ? kAnswerIsNo : code;
}

std::vector<EndingLine> slam_ending(const SlamResult& result, const SlamRun& run, const std::string& folder) {
  const std::size_t rejected = result.loops.rejected();
  std::string way = metres_text(path_length(result));
  if (!result.scans.empty())
    way += " in " + duration_text(stamp_to_seconds(result.scans.back().stamp - result.scans.front().stamp));
  return {
      {"scans", scans_text(result, run)},
      {"way", way},
      {"loops", fmt::format("{}{}", result.loops.accepted, rejected > 0 ? fmt::format(", {} rejected", rejected) : "")},
      {"map", map_text(result.map)},
      {"verdict", verdict_text(result)},
      {"open", (std::filesystem::path(folder) / "report.html").string()},
  };
}

}  // namespace phasescan::app
