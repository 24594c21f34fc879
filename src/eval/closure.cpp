#include "eval/closure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "phasescan/match/scan_matcher.hpp"

namespace phasescan {
namespace {

/// Scans see the less in common the farther apart they stand and the more they are turned.
double apart(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) + 0.5 * angle_distance(a.theta, b.theta);
}

double field_of(const Scan& scan) {
  return scan.size() < 2 ? 0.0 : std::abs(scan.angle(scan.size() - 1) - scan.angle(0));
}

/// The scan nearest to scan `second` among those before `limit`.
std::size_t nearest_before(std::span<const StampedPose> trajectory, std::size_t second, std::size_t limit) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < limit; ++i) {
    if (apart(trajectory[i].pose, trajectory[second].pose) < apart(trajectory[best].pose, trajectory[second].pose))
      best = i;
  }
  return best;
}

constexpr double kWholeTurn = 6.0;    // [rad] a field of view from here on sees all around
constexpr double kMostTurned = 0.35;  // of a smaller one that two scans may be turned against each other

struct Kept {
  Scan scan;
  Pose2 T_base_laser;
};

}  // namespace

Closure closure_errors(LogReader& log, std::span<const StampedPose> trajectory, const ClosureOptions& options) {
  const std::size_t n = trajectory.size();
  const auto least_apart =
      std::max<std::size_t>(1, static_cast<std::size_t>(options.apart_share * static_cast<double>(n)));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t second = least_apart; second < n; ++second) {
    const std::size_t first = nearest_before(trajectory, second, second - least_apart + 1);
    if (translation_distance(trajectory[first].pose, trajectory[second].pose) < options.near_m)
      pairs.emplace_back(first, second);
  }
  if (pairs.size() > options.most) {
    std::vector<std::pair<std::size_t, std::size_t>> some;
    // The last return, the tour's end, is always one of them.
    for (std::size_t k = 1; k <= options.most; ++k) some.push_back(pairs[k * pairs.size() / options.most - 1]);
    pairs.swap(some);
  }
  std::map<std::size_t, Kept> kept;
  for (const auto& [first, second] : pairs) kept[first], kept[second];
  std::size_t count = 0;
  for (auto entry = log.next(); entry; entry = log.next(), ++count) {
    if (const auto at = kept.find(count); at != kept.end())
      at->second = {entry->flipped ? mirrored_scan(entry->scan) : std::move(entry->scan), entry->T_base_laser};
  }
  if (count != n) {
    throw std::invalid_argument("closure: the log has " + std::to_string(count) + " scans, the trajectory " +
                                std::to_string(n) + " poses; expected the same number");
  }
  Closure closure;
  ScanMatcher matcher;
  for (const auto& [first, second] : pairs) {
    const Kept &a = kept[first], &b = kept[second];
    const double turned = angle_distance(trajectory[first].pose.theta, trajectory[second].pose.theta);
    if (field_of(a.scan) < kWholeTurn && turned > kMostTurned * field_of(a.scan)) continue;
    ++closure.looked_at;
    const MatchResult match = matcher.match(a.scan, b.scan);
    if (!match.usable || match.overlap < options.min_overlap) continue;
    const Pose2 T_a_b =
        (trajectory[first].pose * a.T_base_laser).inverse() * (trajectory[second].pose * b.T_base_laser);
    const Pose2 error = match.T_ref_scan.inverse() * T_a_b;
    closure.returns.push_back({first, second, std::hypot(error.x, error.y), std::abs(error.theta)});
  }
  return closure;
}

}  // namespace phasescan
