#include "odometry/scan_clock.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr std::size_t kRing = 31;    // steps that the usual period is the median of
constexpr double kMostJitter = 0.3;  // of a period: median distance of the steps from their median
// More time than both of these without a scan is a gap.
constexpr double kGapPeriods = 15.0, kGapSeconds = 6.0;
constexpr double kMostPeriods = 15.0;  // that a motion is carried on over
constexpr double kPeriodsOfGap = 3.0;  // after a gap no motion is carried on; how much wider the search is
// [s], [periods] A turn that lasts longer is a wrong header.
constexpr double kMostTurnS = 2.0, kMostTurnPeriods = 1.2;

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

ScanTiming ScanClock::add(const Scan& scan) {
  ScanTiming timing;
  if (last) {
    const double step = stamp_to_seconds(scan.stamp - *last);
    if (step < 0.0) {
      ++backwards;
    } else if (step == 0.0) {
      ++repeated;
    } else {
      if (period_s > 0.0) {
        if (step > kGapSeconds && step > kGapPeriods * period_s) {
          timing.gap = true;
          ++gaps;
        }
        // Stamps that jitter by much of a period tell when messages were written, not when scans were taken.
        if (jitter_s < kMostJitter * period_s)
          timing.periods = std::clamp(std::round(step / period_s), 1.0, timing.gap ? kPeriodsOfGap : kMostPeriods);
      }
      if (steps_s.size() < kRing) {
        steps_s.push_back(step);
      } else {
        steps_s[next] = step;
      }
      next = (next + 1) % kRing;
      std::vector<double> steps = steps_s;
      period_s = median_of(steps);
      for (double& s : steps) s = std::abs(s - period_s);
      jitter_s = median_of(steps);
    }
  }
  last = scan.stamp;
  timing.period_s = period_s;
  if (scan.size() > 1) {
    const double duration = std::abs(scan.time_increment) * static_cast<double>(scan.size() - 1);
    if (std::isfinite(duration) && (period_s == 0.0 ? duration < kMostTurnS : duration < kMostTurnPeriods * period_s))
      timing.duration_s = duration;
  }
  return timing;
}

}  // namespace phasescan
