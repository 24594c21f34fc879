#include "eval/reliability_chart.hpp"

#include <cmath>

namespace phasescan {

Chart reliability_axes(const std::string& title) {
  Chart chart;
  chart.title = title;
  chart.subtitle = "tenths of the confidence; whiskers: 95 % Wilson interval";
  chart.x.label = "mean confidence of the bin";
  chart.y.label = "share right";
  chart.x.min = chart.y.min = -0.03;
  chart.x.max = chart.y.max = 1.03;
  chart.equal = true;
  chart.series.push_back({SeriesKind::kLine, "calibrated", {0, 1}, {0, 1}});
  chart.series.back().color = std::string(palette::kGrey);
  chart.series.back().dash = "4 3";
  return chart;
}

Series reliability_points(std::span<const ReliabilityBin> bins) {
  Series s;
  s.kind = SeriesKind::kPoints;
  for (const ReliabilityBin& bin : bins) {
    if (bin.n == 0) continue;
    const auto right = static_cast<std::size_t>(std::lround(bin.right * static_cast<double>(bin.n)));
    const Interval interval = wilson_interval(right, bin.n);
    s.x.push_back(bin.confidence);
    s.y.push_back(bin.right);
    s.low.push_back(interval.low);
    s.high.push_back(interval.high);
  }
  return s;
}

}  // namespace phasescan
