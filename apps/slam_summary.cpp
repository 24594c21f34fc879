#include "slam_summary.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "map/glass.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::app {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double per_unit) {
  return std::round(value * per_unit) / per_unit;
}

/// Scans, loops, wheels, laser, map and warnings.
Json counts_of(const SlamResult& result, const SlamRun& run) {
  const LoopCounts& loops = result.loops;
  const WheelCounts& wheels = result.wheels;
  const TrinaryMap& map = result.map;
  Json warnings = Json::object();
  for (const auto& [kind, count] : run.damages) warnings[kind] = count;
  for (const auto& [kind, oddity] : result.oddities) warnings[kind] = oddity.count;
  if (!result.deskewed && run.deskew_asked) warnings["time_increment not true"] = 1;
  const std::size_t untracked = run.usable - std::min(run.usable, run.tracked);
  if (untracked > 0) warnings["scan not matched"] = untracked;
  if (run.new_segments > 0) warnings["tracking begun anew"] = run.new_segments;
  if (const std::size_t off = result.scans_off_the_map(); off > 0) warnings["scan not on the map"] = off;
  std::size_t occupied = 0, free = 0;
  for (const CellState s : map.cells) occupied += s == CellState::kOccupied, free += s == CellState::kFree;
  return {{"log", std::filesystem::path(run.log).filename().string()},
          {"format", run.format},
          {"complete", run.complete},
          {"scans", result.scans.size()},
          {"scans_usable", run.usable},
          {"scans_tracked", run.tracked},
          {"wide_searches", run.searched},
          {"full_searches_used", run.caught},
          {"keyframes", result.keyframes.size()},
          {"loops",
           {{"compared", loops.compared},
            {"places", loops.places},
            {"found", loops.found},
            {"accepted", loops.accepted},
            {"in_graph", loops.in_graph},
            {"rejected", loops.rejected()},
            {"rejected_undone", loops.undone},
            {"rejected_outvoted", loops.rejected_inconsistent},
            {"rejected_beyond_drift", loops.rejected_beyond_drift},
            {"rejected_alike", loops.rejected_alike}}},
          {"path_length_m", rounded(path_length(result), 1e3)},
          {"odometry",
           {{"used", run.odometry_used},
            {"assumed", run.odometry_assumed},
            {"steps", wheels.steps},
            {"agreed", wheels.agreed},
            {"reversed", wheels.reversed},
            {"slipped", wheels.slipped},
            {"jumped", wheels.jumped}}},
          {"laser",
           {{"x", run.T_base_laser.x},
            {"y", run.T_base_laser.y},
            {"theta", run.T_base_laser.theta},
            {"flipped", run.flipped}}},
          {"map",
           {{"width", map.width},
            {"height", map.height},
            {"resolution_m", map.resolution_m},
            {"occupied_cells", occupied},
            {"free_cells", free},
            {"pieces", result.pieces},
            {"scans_left_out", result.scans_left_out()}}},
          {"warnings", warnings}};
}

/// What the run says of itself, and the numbers that the verdict rests on.
void add_verdict(const SlamResult& result, Json& summary) {
  summary["verdict"] = to_string(result.verdict.verdict);
  summary["verdict_probability"] = rounded(result.verdict.probability, 1e4);
  Json& reasons = summary["reasons"] = Json::array();
  for (const RunFinding& finding : result.findings) {
    reasons.push_back({{"kind", finding.kind},
                       {"count", finding.count},
                       {"first_stamp", stamp_to_seconds(finding.first_stamp)},
                       {"what", finding.what}});
  }
  Json& evidence = summary["evidence"] = Json::object();
  for (const auto& [name, value] : result.verdict.evidence) evidence[name] = rounded(value, 1e5);
}

/// Which log went where.
Json inputs_of(const SlamResult& result, const SlamRun& run) {
  Json list = Json::array();
  for (const SlamInput& input : run.inputs) {
    const auto session = static_cast<std::size_t>(input.session);
    Json line{{"log", std::filesystem::path(input.log).filename().string()},
              {"scans", input.scans},
              {"drive", input.session}};
    if (!input.state.empty()) line["state"] = input.state;
    if (!result.parts.empty() && session < result.sessions.size())
      line["folder"] = std::to_string(result.sessions[session].part + 1);
    list.push_back(std::move(line));
  }
  return list;
}

Json percentiles(std::vector<float> values) {
  if (values.empty()) return Json::object();
  double sum = 0.0;
  for (const float v : values) sum += static_cast<double>(v);
  const double mean = sum / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return rounded(static_cast<double>(values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]),
                   1e4);
  };
  return {{"mean", rounded(mean, 1e4)}, {"p50", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"max", at(1.0)}};
}

Json glass_summary(const std::vector<GlassPane>& panes, bool blocks) {
  std::size_t sure = 0;
  double metres = 0.0, possible_metres = 0.0;
  Json list = Json::array();
  for (const GlassPane& pane : panes) {
    sure += pane.sure;
    (pane.sure ? metres : possible_metres) += pane.length();
    const auto point = [](const Eigen::Vector2d& p) { return Json::array({rounded(p.x(), 1e3), rounded(p.y(), 1e3)}); };
    list.push_back({{"kind", pane.kind == GlassKind::kGlass ? "glass" : "black"},
                    {"sure", pane.sure},
                    {"from", point(pane.a)},
                    {"to", point(pane.b)},
                    {"views", pane.views},
                    {"hits", pane.hits},
                    {"through", pane.through},
                    {"vanished", pane.vanished}});
  }
  return {{"count", sure},
          {"total_m", rounded(metres, 1e2)},
          {"possible_count", panes.size() - sure},
          {"possible_m", rounded(possible_metres, 1e2)},
          {"occupied_in_map", blocks},
          {"panes", list}};
}

}  // namespace

double path_length(const std::vector<Pose2>& poses) {
  // Steps below the noise of standing still are no way.
  double length = 0.0;
  Pose2 last = poses.empty() ? Pose2{} : poses.front();
  for (const Pose2& p : poses) {
    const double step = translation_distance(last, p);
    if (step < 0.02) continue;
    length += step;
    last = p;
  }
  return length;
}

double path_length(const SlamResult& result) {
  const std::vector<Pose2> poses = result.trajectory();
  double length = 0.0;
  for (std::size_t s = 0; s < result.sessions.size(); ++s) {
    const auto begin = poses.begin() + result.sessions[s].first_scan;
    const auto end = s + 1 < result.sessions.size() ? poses.begin() + result.sessions[s + 1].first_scan : poses.end();
    length += path_length(std::vector<Pose2>(begin, end));
  }
  return length;
}

Json summary_of(const SlamResult& result, const SlamRun& run) {
  Json summary = counts_of(result, run);
  add_verdict(result, summary);
  summary["inputs"] = inputs_of(result, run);
  summary["glass"] = glass_summary(result.glass, run.glass_blocks);
  return summary;
}

Json timing_of(const SlamRun& run) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double n = std::max<double>(1.0, static_cast<double>(run.cpu_ms.size()));
  return {{"scans", run.cpu_ms.size()},
          {"cpu_ms_per_scan", rounded(1e3 * run.total_cpu_s / n, 1e4)},
          {"wall_ms_per_scan", rounded(1e3 * run.total_wall_s / n, 1e4)},
          {"tracking_cpu_ms", percentiles(run.tracking_ms)},
          {"step_cpu_ms", percentiles(run.cpu_ms)},
          {"step_wall_ms", percentiles(run.wall_ms)},
          {"peak_memory_mib", rounded(static_cast<double>(usage.ru_maxrss) / 1024.0, 10.0)}};
}

}  // namespace phasescan::app
