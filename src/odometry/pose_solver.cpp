#include "odometry/pose_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"
#include "odometry/resolve_degenerate.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kJudgingPoints = 150;  // points that score a finished match
// Shares of the usual score. Below the first the match against the last scan is asked for: it is more than half of the
// work of a scan, and on the recorded logs a prior that matches above this share do not need. Below the second a better
// pose is searched nearby; below the third even after that the pose falls back to the match against the last scan.
constexpr double kSureShare = 0.95, kMinShare = 0.85, kFallBackShare = 0.7;
constexpr double kClearlyBetter = 0.04;   // of the score, for a pose from the search nearby to be taken instead
constexpr double kSurpriseShare = 0.5;    // of what a match in doubt may lie off what is expected
constexpr double kDoubtfulOverlap = 0.6;  // that a match against the last scan needs which is in doubt
// What a match against the last scan is off by beside what it claims [m], [rad], and how much more than it claims, of
// the covariance: what moved meanwhile is in no claim.
constexpr double kScanToScanM = 0.015, kScanToScanRad = 0.01, kScanToScanFactor = 16.0;

double score_of(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base) {
  return pose_score(map, points, T_map_base, std::max<std::size_t>(1, points.size() / kJudgingPoints));
}

/// What is expected, with what a match against the last scan says.
PosePrior fuse_scan_to_scan(const PosePrior& prior, const LastScanMatch& last) {
  Eigen::Matrix3d covariance = kScanToScanFactor * last.covariance;
  covariance.diagonal() +=
      Eigen::Vector3d(kScanToScanM * kScanToScanM, kScanToScanM * kScanToScanM, kScanToScanRad * kScanToScanRad);
  const Eigen::Matrix3d told = covariance.inverse() / kMatchTrust;
  const Pose2 &a = prior.T_map_base, &b = last.T_map_mid;
  PosePrior both;
  both.information = prior.information + told;
  const Eigen::Vector3d off(b.x - a.x, b.y - a.y, wrap_angle(b.theta - a.theta));
  const Eigen::Vector3d shift = both.information.inverse() * (told * off);
  if (!shift.allFinite()) return prior;
  both.T_map_base = {a.x + shift.x(), a.y + shift.y(), wrap_angle(a.theta + shift.z())};
  return both;
}

/// A scan that is not explained as well as scans usually are: looks for a pose nearby that explains it better.
void search_nearby(const LocalMap& map, const MapPoints& points, double min_overlap, PoseSolution& best) {
  best.wide_search = true;
  for (const LatticeSearch& lattice : {LatticeSearch{0.3, 0.15, 0.72, 0.08, 70}, LatticeSearch{}}) {
    const Pose2 wide = search_lattice(map, points, best.found.T_map_base, lattice);
    PosePrior moved_prior = best.prior;
    moved_prior.T_map_base.theta = wide.theta;
    const Registration again = register_points(map, points, wide, {}, moved_prior);
    const double again_score = score_of(map, points, again.T_map_base);
    if (again_score > best.score + kClearlyBetter) {
      best.found = again;
      best.score = again_score;
    }
    if (best.found.overlap >= min_overlap) return;
  }
}

/// Whether a pose lies farther from what is expected than a share of what a match in doubt may.
bool lies_far(const PoseQuery& query, const Pose2& T_map_base, const SearchPolicy& policy, double share) {
  const Pose2& expected = query.prior.T_map_base;
  return angle_distance(expected.theta, T_map_base.theta) > share * policy.most_doubtful_turn ||
         translation_distance(expected, T_map_base) > share * policy.most_doubtful_m;
}

/// Whether the map alone shows the pose where scans were lost.
bool shows_alone(const PoseQuery& query, const PoseSolution& best, const SearchPolicy& policy) {
  return policy.scans_missing && best.found.overlap >= query.min_overlap &&
         best.score >= policy.alone_share * query.usual_score;
}

/// Tries the match against the last scan as a start.
void fall_back_to_global_match(const LocalMap& map, const MapPoints& points, const PoseQuery& query,
                               const std::optional<LastScanMatch>& last, const SearchPolicy& policy,
                               PoseSolution& best) {
  if (!last || (!last->usable && !policy.try_doubtful_last_scan)) return;
  // The match knows more of the pose now than the motion model does; one in doubt is a place to begin at, no more.
  PosePrior by_match;
  by_match.T_map_base = last->T_map_mid;
  by_match.information = last->usable ? last->covariance.inverse() / kMatchTrust : best.prior.information;
  if (!by_match.information.allFinite()) return;
  // One in doubt may be the symmetry alias of the right one.
  if (!last->usable && (lies_far(query, by_match.T_map_base, policy, 1.0) || shows_alone(query, best, policy))) return;
  const Registration again = register_points(map, points, by_match.T_map_base, {}, by_match);
  const double again_score = score_of(map, points, again.T_map_base);
  if (!last->usable && again.overlap < kDoubtfulOverlap) return;
  const bool surprises = policy.scans_missing && lies_far(query, by_match.T_map_base, policy, kSurpriseShare);
  const double gain = surprises ? kClearlyBetter : policy.last_scan_gain;
  const double needed = best.score + (last->usable ? gain : policy.doubtful_gain);
  const bool instead_of_none = best.found.overlap < query.min_overlap && again_score >= best.score;
  if (again_score < needed && !instead_of_none) return;
  best.found = again;
  best.score = again_score;
  best.prior = by_match;
  best.full_search = true;
}

}  // namespace

PoseSolution solve_pose(const LocalMap& map, const MapPoints& points, const PoseQuery& query,
                        const SearchPolicy& policy) {
  PoseSolution best;
  best.prior = query.prior;
  const auto found = [&] { return best.found.overlap >= query.min_overlap; };
  const auto determined = [&] { return determines_position(kMatchTrust * best.found.information); };
  const auto explains = [&](double share) { return found() && best.score >= share * query.usual_score; };
  best.found = register_points(map, points, query.guess, {}, best.prior);
  best.score = score_of(map, points, best.found.T_map_base);
  if (!policy.always_try_last_scan && explains(kSureShare) && determined()) return best;

  const std::optional<LastScanMatch> last = query.match_last_scan();
  const bool surprises = last && policy.scans_missing && lies_far(query, last->T_map_mid, policy, kSurpriseShare);
  const bool fused = last && last->certain && policy.fuse_last_scan && !surprises;
  if (fused) {
    best.prior = fuse_scan_to_scan(query.prior, *last);
    best.found = register_points(map, points, query.guess, {}, best.prior);
  }
  if (policy.resolve_degenerate && found()) resolve_degenerate_direction(map, points, best.prior, best.found);
  if (!fused && query.learned && found() && !determined()) {
    best.prior = *query.learned;
    best.found = register_points(map, points, best.prior.T_map_base, {}, best.prior);
  }
  best.score = score_of(map, points, best.found.T_map_base);
  if (policy.always_try_last_scan || surprises) fall_back_to_global_match(map, points, query, last, policy, best);
  if (best.full_search || explains(kMinShare)) return best;
  search_nearby(map, points, query.min_overlap, best);
  if (!explains(kFallBackShare)) fall_back_to_global_match(map, points, query, last, policy, best);
  return best;
}

}  // namespace phasescan
