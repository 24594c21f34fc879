#include "slam/run_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "slam/finished_map.hpp"
#include "slam/path_covariance.hpp"

namespace phasescan {
namespace {

constexpr double kRightM = 0.2, kRightShare = 0.01;    // error of a map that is right: metres, or share of the way
constexpr std::size_t kMostAsked = 500;                // keyframes whose covariance is looked at
constexpr double kStillM = 0.02;                       // steps below are the noise of standing still
constexpr double kGapPeriods = 1.8;                    // a step so long has lost a scan
constexpr double kLeastSpeed = 0.1, kLeastTurn = 0.2;  // [m/s], [rad/s] that jumps are measured by, where all is slow

std::size_t index(std::int64_t k) {
  return static_cast<std::size_t>(k);
}

double share(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

/// The value that a share `q` of all is below; 0 of none.
double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Scans that could be matched, and what became of them.
void count_scans(const SlamResult& result, RunEvidence& e) {
  double messages = 0.0, repeated = 0.0, on_map = 0.0;
  for (const ScanResult& scan : result.scans) {
    ++messages;
    repeated += scan.repeated;
    if (scan.repeated) continue;
    const bool tracked = is_tracked(scan.status);
    e.degraded += scan.status == TrackingStatus::kDegraded;
    e.ambiguous += scan.status == TrackingStatus::kAmbiguous;
    e.left_out += scan.left_out;
    e.off_map += !scan.on_map;
    on_map += tracked && scan.on_map && !scan.left_out;
    e.lost += !tracked && !scan.left_out;
  }
  const auto empty = result.oddities.find("scan without a return");
  const double none = empty == result.oddities.end() ? 0.0 : static_cast<double>(empty->second.count);
  e.scans = messages - repeated;
  const double usable = std::max(0.0, e.scans - none);
  e.on_map = std::min(1.0, share(on_map, usable));
  e.lost = share(std::max(0.0, e.lost - none), usable);
  for (double* part : {&e.degraded, &e.ambiguous, &e.left_out, &e.off_map}) *part = share(*part, e.scans);
  e.repeated = share(repeated, messages);
}

/// A step of the way between two scans that were matched.
struct Step {
  std::size_t from = 0, to = 0;  ///< scans
  double time_s = 0.0;
};

/// Whether a scan counts for the way as the map has it.
bool is_on_way(const ScanResult& scan) {
  return !scan.repeated && !scan.left_out && scan.on_map && is_tracked(scan.status);
}

/// Steps within drives; what lies between two drives is no way.
std::vector<Step> steps_of(const SlamResult& result) {
  std::vector<Step> steps;
  std::size_t drive = 0;
  std::int64_t last = -1;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    while (drive < result.sessions.size() && index(result.sessions[drive].first_scan) <= i) {
      last = index(result.sessions[drive].first_scan) == i ? -1 : last;
      ++drive;
    }
    if (!is_on_way(result.scans[i])) continue;
    const Stamp stamp = result.scans[i].stamp;
    if (last >= 0 && stamp > result.scans[index(last)].stamp)
      steps.push_back({index(last), i, stamp_to_seconds(stamp - result.scans[index(last)].stamp)});
    last = static_cast<std::int64_t>(i);
  }
  return steps;
}

void follow_way(const SlamResult& result, RunEvidence& e) {
  std::vector<double> periods, speeds, turns;
  std::optional<Pose2> counted;
  const std::vector<Step> steps = steps_of(result);
  for (const ScanResult& scan : result.scans) {
    if (!is_on_way(scan)) continue;
    if (!counted) counted = scan.T_map_base;
    e.moved_m = std::max(e.moved_m, translation_distance(scan.T_map_base, scan.T_odom_base));
    if (translation_distance(*counted, scan.T_map_base) < kStillM) continue;
    e.way_m += translation_distance(*counted, scan.T_map_base);
    counted = scan.T_map_base;
  }
  for (const Step& step : steps) periods.push_back(step.time_s);
  const double period = quantile(periods, 0.5);
  double fastest = 0.0, fastest_turn = 0.0, missed = 0.0;
  for (const Step& step : steps) {
    const Pose2 moved = result.scans[step.from].T_map_base.inverse() * result.scans[step.to].T_map_base;
    const double way = moved.translation().norm(), turn = std::abs(moved.theta);
    e.duration_s += step.time_s;
    if (step.time_s > e.longest_gap_s) {
      e.longest_gap_s = step.time_s;
      e.gap_scan = static_cast<ScanId>(step.from);
    }
    if (step.time_s > kGapPeriods * period) {
      missed += step.time_s - period;
      e.longest_gap_m = std::max(e.longest_gap_m, way);
      e.longest_gap_turn = std::max(e.longest_gap_turn, turn);
    }
    speeds.push_back(way / std::max(step.time_s, 0.5 * period));
    turns.push_back(turn / std::max(step.time_s, 0.5 * period));
    fastest = std::max(fastest, speeds.back());
    fastest_turn = std::max(fastest_turn, turns.back());
  }
  e.gaps = share(missed, e.duration_s);
  e.jump = fastest / std::max(kLeastSpeed, quantile(speeds, 0.95));
  e.turn_jump = fastest_turn / std::max(kLeastTurn, quantile(turns, 0.95));
}

void count_loops_and_wheels(const SlamResult& result, RunEvidence& e) {
  const LoopCounts& loops = result.loops;
  const auto found = static_cast<double>(loops.found);
  e.loops_found = found;
  e.undone = share(static_cast<double>(loops.undone), found);
  e.beyond_drift = share(static_cast<double>(loops.rejected_beyond_drift), found);
  e.alike = share(static_cast<double>(loops.rejected_alike), found);
  e.inconsistent = share(static_cast<double>(loops.rejected_inconsistent), found);
  const WheelCounts& wheels = result.wheels;
  const auto steps = static_cast<double>(wheels.steps);
  e.wheels = share(steps, e.scans);
  e.wheels_agreed = share(static_cast<double>(wheels.agreed), steps);
  e.wheels_slipped = share(static_cast<double>(wheels.slipped), steps);
  e.wheels_reversed = share(static_cast<double>(wheels.reversed), steps);
  e.wheels_jumped = share(static_cast<double>(wheels.jumped), e.scans);
}

/// How the graph fits its edges, of those between nodes that are drawn.
void look_at_graph(const FinishedRun& run, RunEvidence& e) {
  const Backend& backend = *run.backend;
  std::vector<char> drawn(backend.keyframes().size(), 0);
  for (const int node : run.nodes) drawn[index(node)] = 1;
  double steps = 0.0, loops = 0.0;
  const std::vector<PoseEdge>& edges = backend.graph().edges();
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const PoseEdge& edge = edges[k];
    if (!edge.enabled || !drawn[index(edge.from)] || !drawn[index(edge.to)]) continue;
    const bool is_break = !edge.robust && backend.keyframes()[index(edge.to)].new_segment;
    e.breaks += is_break;
    if (is_break) continue;
    const Pose2 error = backend.graph().edge_error(static_cast<int>(k));
    const double chi2 = backend.graph().edge_chi2(static_cast<int>(k));
    if (edge.robust) {
      ++loops;
      e.loop_chi2 += chi2;
      e.worst_loop_chi2 = std::max(e.worst_loop_chi2, chi2);
    } else {
      ++steps;
      e.step_chi2 += chi2;
      e.worst_step_chi2 = std::max(e.worst_step_chi2, chi2);
      e.step_bend_m = std::max(e.step_bend_m, error.translation().norm());
      e.step_bend_turn = std::max(e.step_bend_turn, std::abs(error.theta));
    }
  }
  e.step_chi2 = share(e.step_chi2, steps);
  e.loop_chi2 = share(e.loop_chi2, loops);
  e.keyframes = static_cast<double>(run.nodes.size());
  e.loops_per_keyframe = share(loops, e.keyframes);
  e.pieces = run.result->pieces;
}

/// How far keyframes may be off, seen from the one in the middle of the run; and how far the last pass moved them.
void look_at_keyframes(const FinishedRun& run, RunEvidence& e) {
  if (run.nodes.empty()) return;
  PathCovariance covariance;
  covariance.rebuild(run.backend->session());
  const int middle = run.nodes[run.nodes.size() / 2];
  double expected = 0.0, refined = 0.0;
  std::vector<double> points;
  const std::size_t stride = 1 + run.nodes.size() / kMostAsked;
  double asked = 0.0;
  for (std::size_t k = 0; k < run.nodes.size(); ++k) {
    const int node = run.nodes[k];
    if (k % stride == 0) {
      const Eigen::Matrix3d c = covariance.between(std::min(middle, node), std::max(middle, node));
      const double variance = std::max(0.0, c(0, 0) + c(1, 1));
      expected += variance;
      ++asked;
      e.worst_expected_m = std::max(e.worst_expected_m, std::sqrt(variance));
    }
    const Keyframe& keyframe = run.backend->keyframes()[index(node)];
    points.push_back(static_cast<double>(keyframe.points->size()));
    const double moved =
        translation_distance(run.T_map_stamp[k], run.backend->poses()[index(node)] * keyframe.T_mid_stamp);
    refined += moved * moved;
    e.worst_refined_m = std::max(e.worst_refined_m, moved);
  }
  e.points = quantile(std::move(points), 0.5);
  const auto n = static_cast<double>(run.nodes.size());
  e.expected_m = std::sqrt(expected / asked);
  e.expected_ratio = e.expected_m / std::max(kRightM, kRightShare * e.way_m);
  e.refined_m = std::sqrt(refined / n);
}

void look_at_map(const FinishedRun& run, RunEvidence& e) {
  std::vector<double> way_m;
  for (std::size_t k = 0; k < run.nodes.size(); ++k)
    way_m.push_back(k == 0 ? 0.0 : way_m.back() + translation_distance(run.T_map_stamp[k - 1], run.T_map_stamp[k]));
  const auto placed = [&run](std::size_t k) {
    return place_keyframe(run.backend->keyframes()[index(run.nodes[k])], run.T_map_stamp[k], run.deskew);
  };
  e.map = check_map(run.nodes.size(), placed, way_m);
  if (e.map.far.scans > 0) e.contradicted_scan = run.scans[e.map.far.worst_scan];
}

}  // namespace

RunEvidence gather_evidence(const FinishedRun& run) {
  RunEvidence e;
  count_scans(*run.result, e);
  follow_way(*run.result, e);
  count_loops_and_wheels(*run.result, e);
  look_at_graph(run, e);
  look_at_keyframes(run, e);
  look_at_map(run, e);
  e.overlap = run.fit.mean_overlap();
  e.kept = share(static_cast<double>(run.fit.kept), static_cast<double>(run.fit.scans));
  e.body_sectors = static_cast<double>(run.body_sectors);
  return e;
}

}  // namespace phasescan
