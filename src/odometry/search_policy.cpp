#include "odometry/search_policy.hpp"

#include <algorithm>

namespace phasescan {
namespace {

// Sparse logs: the full search is taken if it explains so little less of the score.
constexpr double kHardlyWorse = 0.05;
// Where scans stand far apart, the next ones share less and less with the map that lost this one.
constexpr int kSparseLostAfter = 2;

}  // namespace

SearchPolicy search_policy(const MotionVariability& variability, const OdometryOptions& options) {
  SearchPolicy policy;
  policy.lost_after_scans = options.lost_after_scans;
  if (!variability.is_sparse()) return policy;
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
