#include "odometry/search_policy.hpp"

#include <algorithm>

namespace phasescan {
namespace {

// Sparse logs: the full search is taken if it explains so little less of the score.
constexpr double kHardlyWorse = 0.05;
// Where scans stand far apart, the next ones share less and less with the map that lost this one.
constexpr int kSparseLostAfter = 2;
// How far indoor robots may be from where they would be had they gone on as before [m], [rad], and for each second.
constexpr double kOffM = 0.3, kOffMPerS = 0.7, kOffRad = 0.3, kOffRadPerS = 1.5;

}  // namespace

SearchPolicy search_policy(const MotionVariability& variability, const OdometryOptions& options,
                           const ScanTiming& timing) {
  SearchPolicy policy;
  policy.lost_after_scans = options.lost_after_scans;
  if (!variability.is_sparse()) {
    const double lost_s = timing.lost_s(), missing_s = std::max(lost_s, timing.unsure_s);
    policy.scans_missing = missing_s > 0.0 || timing.unsteady;
    policy.must_explain = lost_s > 0.0;
    // Along a corridor a map explains a scan anywhere: the match in doubt is tried whatever the map says.
    if (timing.unsure_s > 0.0) policy.alone_share = 1e9;
    if (policy.scans_missing) {
      policy.most_doubtful_turn = kOffRad + kOffRadPerS * missing_s;
      policy.most_doubtful_m = kOffM + kOffMPerS * missing_s;
    }
    if (missing_s > 0.0) {
      policy.always_try_last_scan = true;
      policy.last_scan_gain = -kHardlyWorse;
      policy.try_doubtful_last_scan = true;
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
