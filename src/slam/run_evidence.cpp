#include "slam/run_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "slam/evidence_numbers.hpp"
#include "slam/finished_map.hpp"
#include "slam/path_covariance.hpp"
#include "slam/way_evidence.hpp"

namespace phasescan {
namespace {

using namespace evidence;

constexpr double kUntiedSigmaM = 1000.0;  // of a keyframe that no edge ties to the others
constexpr double kTailShare = 0.05;       // of edges: those that fit worst
constexpr double kUsualLoops = 0.5;       // of a keyframe: they halve what is not confirmed
constexpr double kMostUnseen = 40.0;      // longest gap of the runs that verdicts were fitted on

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
  e.wheels_way_m = wheels.wheels_m;
  e.wheels_seen_m = wheels.scans_m;
}

/// Mean of the share of the largest that kTailShare is, of at least one: an extreme of many would grow with the run.
double tail(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto count = static_cast<std::size_t>(std::ceil(kTailShare * static_cast<double>(values.size())));
  std::sort(values.begin(), values.end(), std::greater<>());
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

/// How the graph fits its edges, of those between nodes that are drawn.
void look_at_graph(const FinishedRun& run, RunEvidence& e) {
  const Backend& backend = *run.backend;
  std::vector<char> drawn(backend.keyframes().size(), 0);
  for (const int node : run.nodes) drawn[index(node)] = 1;
  std::vector<double> steps, loops;
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
      loops.push_back(chi2);
    } else {
      steps.push_back(chi2);
      e.step_bend_m = std::max(e.step_bend_m, error.translation().norm());
      e.step_bend_turn = std::max(e.step_bend_turn, std::abs(error.theta));
    }
  }
  e.step_chi2 = mean(steps);
  e.loop_chi2 = mean(loops);
  e.loops_per_keyframe = share(static_cast<double>(loops.size()), static_cast<double>(run.nodes.size()));
  e.step_chi2_tail = tail(std::move(steps));
  e.loop_chi2_tail = tail(std::move(loops));
  e.bend_ratio = e.step_bend_m / right_m(e);
  e.keyframes = static_cast<double>(run.nodes.size());
  e.pieces = run.result->pieces;
}

/// How far keyframes may be off, seen from the one in the middle of the run; and how far the last pass moved them.
void look_at_keyframes(const FinishedRun& run, RunEvidence& e) {
  if (run.nodes.empty()) return;
  const std::vector<double> sigmas = position_sigmas(run.backend->session(), run.nodes[run.nodes.size() / 2]);
  double expected = 0.0, refined = 0.0;
  std::vector<double> points;
  for (std::size_t k = 0; k < run.nodes.size(); ++k) {
    const int node = run.nodes[k];
    const double sigma = std::min(kUntiedSigmaM, sigmas[index(node)]);
    expected += sigma * sigma;
    const Keyframe& keyframe = run.backend->keyframes()[index(node)];
    points.push_back(static_cast<double>(keyframe.points->size()));
    const double moved =
        translation_distance(run.T_map_stamp[k], run.backend->poses()[index(node)] * keyframe.T_mid_stamp);
    refined += moved * moved;
  }
  e.points = quantile(std::move(points), 0.5);
  const auto n = static_cast<double>(run.nodes.size());
  e.expected_m = std::sqrt(expected / n);
  e.expected_ratio = e.expected_m / right_m(e);
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
  if (e.map.far.scans == 0) return;
  e.contradicted_scan = run.scans[e.map.far.worst_scan];
  const VisitShares &far = e.map.far.mean, &near = e.map.near.mean;
  const auto above = [](double a, double b) { return std::max(0.0, a - b); };
  e.excess = {above(far.crossed, near.crossed), above(far.doubled, near.doubled), above(far.in_free, near.in_free)};
}

/// What only several of the numbers say together.
void combine(RunEvidence& e) {
  const double unaided = 1.0 - std::min(1.0, e.wheels) * e.wheels_agreed;
  e.lost_unaided = unaided * e.lost;
  const double unseen = e.wheels_jumped > 0.0 ? 1.0 : unaided;  // over a long way wheels jump: they say nothing of it
  e.unseen_ratio = std::min(kMostUnseen, unseen * e.longest_gap_s * share(e.way_m, e.duration_s) / right_m(e));
  e.doubted = e.beyond_drift + e.alike + e.inconsistent;
  e.unseen_doubted = e.unseen_ratio * e.doubted;
  e.open_doubted = e.expected_ratio * e.doubted;
  e.off_map_ratio = std::sqrt(e.off_map) / right_m(e);
  const double wide = unaided * e.degraded;  // where scans are few that is no bad sign by itself
  e.degraded_unconfirmed = wide / (1.0 + e.loops_per_keyframe / kUsualLoops);
  e.degraded_bent = wide * e.step_chi2_tail;
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
  e.no_overlap = 1.0 - e.overlap;
  e.kept = share(static_cast<double>(run.fit.kept), static_cast<double>(run.fit.scans));
  e.body_sectors = static_cast<double>(run.body_sectors);
  combine(e);
  e.wheels_scan = run.wheels_scan;
  e.doubted_scan = run.doubted_scan;
  return e;
}

}  // namespace phasescan
