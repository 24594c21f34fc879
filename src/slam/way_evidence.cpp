#include "slam/way_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "slam/evidence_numbers.hpp"

namespace phasescan {
namespace {

using namespace evidence;

constexpr double kStillM = 0.02;                       // steps below are the noise of standing still
constexpr double kGapPeriods = 1.8;                    // a step so long has lost a scan
constexpr double kLeastSpeed = 0.1, kLeastTurn = 0.2;  // [m/s], [rad/s] that jumps are measured by, where all is slow
constexpr double kUsualShare = 0.95;                   // of the steps: as far and fast as the robot goes
constexpr double kMuchFaster = 1.5;                    // than that: no step of the way

/// A step of the way between two scans that were matched.
struct Step {
  std::size_t from = 0, to = 0;  ///< scans
  double time_s = 0.0, way_m = 0.0, turn = 0.0;
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
    if (last >= 0 && stamp > result.scans[index(last)].stamp) {
      const ScanResult& before = result.scans[index(last)];
      const Pose2 moved = before.T_map_base.inverse() * result.scans[i].T_map_base;
      steps.push_back(
          {index(last), i, stamp_to_seconds(stamp - before.stamp), moved.translation().norm(), std::abs(moved.theta)});
    }
    last = static_cast<std::int64_t>(i);
  }
  return steps;
}

/// A run of bounded memory, which keeps no covariances, may have left out scans of long ago: that is no gap.
bool may_be_thinned(const SlamResult& result) {
  return !result.scans.empty() && !result.scans.front().covariance;
}

/// Time from scan to scan near a step.
double usual_near(const std::vector<double>& periods, std::size_t k) {
  constexpr std::size_t kNear = 15;  // steps before, and after
  const std::size_t from = k - std::min(k, kNear), to = std::min(periods.size(), k + kNear + 1);
  return quantile(
      {periods.begin() + static_cast<std::ptrdiff_t>(from), periods.begin() + static_cast<std::ptrdiff_t>(to)}, 0.5);
}

/// How much faster and farther than all others the robot goes in one step: where the map has it jump.
void look_for_jumps(const std::vector<Step>& steps, double period, RunEvidence& e) {
  std::vector<double> ways, speeds, turns;
  for (const Step& step : steps) {
    const double time = std::max(step.time_s, 0.5 * period);
    ways.push_back(step.way_m);
    speeds.push_back(step.way_m / time);
    turns.push_back(step.turn / time);
  }
  const auto times_most = [](const std::vector<double>& values, double least) {
    return quantile(values, 1.0) / std::max(least, quantile(values, kUsualShare));
  };
  e.jump = times_most(speeds, kLeastSpeed);
  e.turn_jump = times_most(turns, kLeastTurn);
  const double far = quantile(ways, kUsualShare), fast = std::max(kLeastSpeed, quantile(speeds, kUsualShare));
  double jump_m = 0.0;
  for (const Step& step : steps)
    jump_m = std::max(jump_m, step.way_m - kMuchFaster * std::max(far, fast * step.time_s));
  e.jump_ratio = jump_m / right_m(e);
}

}  // namespace

void follow_way(const SlamResult& result, RunEvidence& e) {
  std::vector<double> periods;
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
  const bool thinned = may_be_thinned(result);
  double missed = 0.0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Step& step = steps[k];
    const double usual_s = thinned ? usual_near(periods, k) : period;
    e.duration_s += step.time_s;
    if (step.time_s > e.longest_gap_s) {
      e.longest_gap_s = step.time_s;
      e.gap_scan = static_cast<ScanId>(step.from);
    }
    if (step.time_s > kGapPeriods * usual_s) {
      missed += step.time_s - usual_s;
      e.longest_gap_m = std::max(e.longest_gap_m, step.way_m);
      e.longest_gap_turn = std::max(e.longest_gap_turn, step.turn);
    }
  }
  e.gaps = share(missed, e.duration_s);
  look_for_jumps(steps, period, e);
}

}  // namespace phasescan
