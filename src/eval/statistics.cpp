#include "eval/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
}  // namespace

Interval wilson_interval(std::size_t hits, std::size_t n) {
  if (n == 0) return {0.0, 1.0};
  constexpr double z = 1.959963984540054;  // two-sided 95 % of the normal distribution
  const double count = static_cast<double>(n), p = static_cast<double>(hits) / count;
  const double scale = 1.0 / (1.0 + z * z / count);
  const double center = (p + z * z / (2.0 * count)) * scale;
  const double half = z * scale * std::sqrt(p * (1.0 - p) / count + z * z / (4.0 * count * count));
  return {hits == 0 ? 0.0 : std::max(0.0, center - half), hits == n ? 1.0 : std::min(1.0, center + half)};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const double place = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

Moments moments(std::span<const double> values) {
  Moments m{values.size(), kNan, kNan, kNan, kNan};
  if (values.empty()) return m;
  const double n = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double v : values) sum += v;
  m.mean = sum / n;
  double squares = 0.0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  m.variance = values.size() > 1 ? squares / (n - 1.0) : 0.0;
  m.std = std::sqrt(m.variance);
  m.median = quantile({values.begin(), values.end()}, 0.5);
  return m;
}

double area_under_roc(std::span<const Judgement> judgements) {
  std::vector<Judgement> sorted(judgements.begin(), judgements.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Judgement& a, const Judgement& b) { return a.confidence < b.confidence; });
  double right = 0.0, wrong = 0.0, rank_sum = 0.0;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i;
    double right_here = 0.0;
    for (; end < sorted.size() && sorted[end].confidence == sorted[i].confidence; ++end)
      right_here += sorted[end].right;
    const double ties = static_cast<double>(end - i), wrong_here = ties - right_here;
    rank_sum += right_here * (wrong + 0.5 * wrong_here);  // wrong answers below, and half of those level
    right += right_here;
    wrong += wrong_here;
    i = end;
  }
  return right > 0.0 && wrong > 0.0 ? rank_sum / (right * wrong) : kNan;
}

std::vector<ReliabilityBin> reliability(std::span<const Judgement> judgements, int bins) {
  std::vector<ReliabilityBin> out(static_cast<std::size_t>(std::max(bins, 1)));
  for (const Judgement& j : judgements) {
    const auto place = static_cast<std::size_t>(std::clamp(j.confidence, 0.0, 1.0) * static_cast<double>(out.size()));
    ReliabilityBin& bin = out[std::min(place, out.size() - 1)];
    ++bin.n;
    bin.confidence += j.confidence;
    bin.right += j.right;
  }
  for (ReliabilityBin& bin : out) {
    if (bin.n == 0) continue;
    bin.confidence /= static_cast<double>(bin.n);
    bin.right /= static_cast<double>(bin.n);
  }
  return out;
}

double calibration_error(std::span<const Judgement> judgements, int bins) {
  if (judgements.empty()) return kNan;
  double sum = 0.0;
  for (const ReliabilityBin& bin : reliability(judgements, bins)) {
    sum += static_cast<double>(bin.n) * std::abs(bin.right - bin.confidence);
  }
  return sum / static_cast<double>(judgements.size());
}

}  // namespace phasescan
