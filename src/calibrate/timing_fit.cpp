#include "calibrate/timing_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan {
namespace {

/// Covariances of intervals and those some revolutions later, over stretches without a gap.
struct Covariances {
  static constexpr std::size_t kLags = 8;
  std::array<double, kLags + 1> at{};
};

Covariances covariances(const std::vector<double>& intervals, double mean, double low, double high) {
  Covariances out;
  std::array<double, Covariances::kLags + 1> counts{};
  const auto regular = [&](std::size_t i) { return intervals[i] > low && intervals[i] < high; };
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    for (std::size_t lag = 0; lag <= Covariances::kLags && i + lag < intervals.size() && regular(i + lag); ++lag) {
      out.at[lag] += (intervals[i] - mean) * (intervals[i + lag] - mean);
      counts[lag] += 1.0;
    }
  }
  for (std::size_t lag = 0; lag < counts.size(); ++lag) out.at[lag] /= std::max(1.0, counts[lag]);
  return out;
}

void fit_wander(const Covariances& c, double period, double count, TimingFit& fit) {
  constexpr std::size_t kLast = Covariances::kLags;
  const double by_chance = 3.0 * c.at[0] / std::sqrt(count);
  double variance = c.at[0] + 2.0 * std::min(0.0, c.at[1]);
  if (c.at[2] > by_chance && c.at[kLast] > 0.0) {
    const double memory = std::clamp(std::pow(c.at[kLast] / c.at[2], 1.0 / (kLast - 2.0)), 0.01, 0.9999);
    variance = std::min(c.at[0], c.at[2] / (memory * memory));
    fit.wander_s = -period / std::log(memory);
  }
  fit.wander = std::sqrt(std::max(0.0, variance)) / period;
}

}  // namespace

TimingFit fit_timing(const std::vector<Stamp>& stamps) {
  constexpr double kLongest = 50.0, kLow = 0.6, kHigh = 1.5;
  constexpr std::size_t kLeast = 10;
  TimingFit fit;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) intervals.push_back(static_cast<double>(stamps[i] - stamps[i - 1]) * 1e-9);
  }
  if (intervals.size() < kLeast) return fit;
  std::vector<double> sorted = intervals;
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted[sorted.size() / 2];
  double sum = 0.0, count = 0.0;
  std::vector<int> bursts;
  for (const double interval : intervals) {
    if (interval > kLow * middle && interval < kHigh * middle) {
      sum += interval;
      count += 1.0;
    } else if (interval >= kHigh * middle && interval < kLongest * middle) {
      bursts.push_back(static_cast<int>(std::lround(interval / middle)) - 1);
    }
  }
  if (count < static_cast<double>(kLeast)) return fit;
  const double period = sum / count;
  fit.rate_hz = 1.0 / period;
  fit.intervals = intervals.size();
  fit_wander(covariances(intervals, period, kLow * middle, kHigh * middle), period, count, fit);
  if (bursts.empty()) return fit;
  std::sort(bursts.begin(), bursts.end());
  const std::size_t end = bursts.size() - 1, rare = bursts.size() / 50;
  fit.lost_share = static_cast<double>(bursts.size()) / (count + static_cast<double>(bursts.size()));
  fit.burst_min = std::max(1, bursts[rare]);
  fit.burst_max = std::max(fit.burst_min, bursts[end - rare]);
  return fit;
}

}  // namespace phasescan
