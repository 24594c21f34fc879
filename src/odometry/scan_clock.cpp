#include "phasescan/odometry/scan_clock.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr std::size_t kRing = 31;
constexpr double kGapPeriods = 15.0, kGapSeconds = 2.0;

}  // namespace

ScanTiming ScanClock::add(const Scan& scan) {
  ScanTiming timing;
  if (last_) {
    const double step = stamp_to_seconds(scan.stamp - *last_);
    if (step < 0.0) {
      ++counts_.backwards;
    } else if (step == 0.0) {
      ++counts_.repeated;
    } else {
      if (period_s_ > 0.0) {
        if (step > kGapSeconds && step > kGapPeriods * period_s_) {
          timing.gap = true;
          ++counts_.gaps;
        }
        timing.periods = std::clamp(std::round(step / period_s_), 1.0, 3.0);
      }
      if (steps_s_.size() < kRing) {
        steps_s_.push_back(step);
      } else {
        steps_s_[next_] = step;
      }
      next_ = (next_ + 1) % kRing;
      std::vector<double> sorted = steps_s_;
      std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
      period_s_ = sorted[sorted.size() / 2];
    }
  }
  last_ = scan.stamp;
  timing.period_s = period_s_;
  if (scan.size() > 1) {
    const double duration = std::abs(scan.time_increment) * static_cast<double>(scan.size() - 1);
    // A turn that lasts longer than the time between turns is a wrong header.
    if (std::isfinite(duration) && (period_s_ == 0.0 ? duration < 2.0 : duration < 1.2 * period_s_))
      timing.duration_s = duration;
  }
  return timing;
}

}  // namespace phasescan
