#include "odometry/scan_clock.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace phasescan {
namespace {

constexpr std::size_t kRing = 31;    // steps that the usual period is the median of
constexpr double kMostJitter = 0.3;  // of a period: median distance of the steps from their median
// More time than both of these without a scan is a gap.
constexpr double kGapPeriods = 15.0, kGapSeconds = 6.0;
constexpr double kPeriodsOfGap = 3.0;  // after a gap no motion is carried on; how much wider the search is
// Scans written several at a time: a quarter of the steps is so much longer than the usual one. Lost scans make fewer.
constexpr double kLongShare = 0.75, kLongSteps = 2.5;
constexpr double kUnsureSteps = 2.5;  // times the mean step of stamps that jitter: scans may be missing
// [s], [periods] A turn that lasts longer is a wrong header.
constexpr double kMostTurnS = 2.0, kMostTurnPeriods = 1.2;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The value that a share `q` of all is below.
double quantile_of(std::vector<double>& values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double median_of(std::vector<double>& values) {
  return quantile_of(values, 0.5);
}

/// Whether a quarter of the steps is much longer than the usual one: several scans are written at a time.
bool comes_in_bursts(std::vector<double> steps_s, double usual_s) {
  return quantile_of(steps_s, kLongShare) > kLongSteps * usual_s;
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
        timing.unsteady = jitter_s >= kMostJitter * period_s || comes_in_bursts(steps_s, period_s);
        if (!timing.unsteady) {
          timing.periods =
              std::clamp(std::round(step / period_s), 1.0, timing.gap ? kPeriodsOfGap : ScanTiming::kMostPeriods);
        } else if (step > kUnsureSteps * mean_of(steps_s) && !timing.gap) {
          timing.unsure_s = step;
        }
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
