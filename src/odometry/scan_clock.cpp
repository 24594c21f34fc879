#include "odometry/scan_clock.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr std::size_t kRing = 31;
constexpr double kMostJitter = 0.3;  // of a period: median distance of the steps from their median
constexpr double kGapPeriods = 15.0, kGapSeconds = 2.0;

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
        // Stamps that jitter by much of a period tell when messages were written, not when scans were taken.
        if (jitter_s_ < kMostJitter * period_s_) timing.periods = std::clamp(std::round(step / period_s_), 1.0, 3.0);
      }
      if (steps_s_.size() < kRing) {
        steps_s_.push_back(step);
      } else {
        steps_s_[next_] = step;
      }
      next_ = (next_ + 1) % kRing;
      std::vector<double> steps = steps_s_;
      period_s_ = median_of(steps);
      for (double& s : steps) s = std::abs(s - period_s_);
      jitter_s_ = median_of(steps);
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
