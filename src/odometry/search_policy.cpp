#include "odometry/search_policy.hpp"

#include <algorithm>

namespace phasescan {
namespace {

// Sparse logs: the full search is taken if it explains so little less of the score.
constexpr double kHardlyWorse = 0.05;
// Where scans stand far apart, the next ones share less and less with the map that lost this one.
constexpr int kSparseLostAfter = 2;
// Where scans were lost: share of the usual score from which on the map alone shows the pose. Rooms look alike.
constexpr double kAloneShare = 0.75;
// How far indoor robots may be from where they would be had they gone on as before [m], [rad], and for each second.
constexpr double kOffM = 0.3, kOffMPerS = 0.7, kOffRad = 0.3, kOffRadPerS = 1.5;

}  // namespace

SearchPolicy search_policy(const MotionVariability& variability, const OdometryOptions& options, double lost_s) {
  SearchPolicy policy;
  policy.lost_after_scans = options.lost_after_scans;
  if (!variability.is_sparse()) {
    if (lost_s > 0.0) {
      policy.always_try_last_scan = true;
      policy.last_scan_gain = -kHardlyWorse;
      policy.try_doubtful_last_scan = true;
      policy.most_doubtful_turn = kOffRad + kOffRadPerS * lost_s;
      policy.most_doubtful_m = kOffM + kOffMPerS * lost_s;
      policy.least_share_alone = kAloneShare;
    }
    return policy;
  }
  policy.lines = WallLines{};
  policy.filter_free_standing = false;
  policy.place_new_laser_by_motion = false;
  policy.fuse_last_scan = false;
  policy.resolve_degenerate = false;
  policy.always_try_last_scan = true;
  policy.try_doubtful_last_scan = true;
  policy.last_scan_gain = -kHardlyWorse;
  policy.doubtful_gain = 0.0;
  policy.change_m = variability.change_m();
  policy.change_rad = variability.change_rad();
  policy.lost_after_scans = std::min(kSparseLostAfter, options.lost_after_scans);
  return policy;
}

}  // namespace phasescan
