#include "report/chart_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

int decimals_for(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
}

std::string log_label(double value) {
  if (value >= 1e-3 && value < 1e5) return plain_number(value, 4);
  return "1e" + std::to_string(static_cast<int>(std::lround(std::log10(value))));
}

}  // namespace

double AxisScale::operator()(double value) const {
  const double t = log ? (std::log10(std::max(value, 1e-300)) - std::log10(low)) / (std::log10(high) - std::log10(low))
                       : (value - low) / (high - low);
  return px_low + t * (px_high - px_low);
}

std::vector<double> nice_ticks(double low, double high, int target) {
  if (!(high > low) || target < 1) return {low};
  const double raw = (high - low) / target;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double digit = raw / power;
  const double step = power * (digit <= 1.0 ? 1.0 : digit <= 2.0 ? 2.0 : digit <= 5.0 ? 5.0 : 10.0);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

AxisScale axis_limits(const ChartAxis& axis, const std::vector<Series>& series, bool is_y) {
  AxisScale scale;
  scale.log = axis.log;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](const std::vector<double>& values) {
    for (const double v : values) {
      if (!std::isfinite(v) || (axis.log && v <= 0.0)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  };
  bool bars = false;
  for (const Series& s : series) {
    take(is_y ? s.y : s.x);
    if (is_y) {
      take(s.low);
      take(s.high);
      bars = bars || s.kind == SeriesKind::kBars;
    }
  }
  if (!axis.categories.empty()) {
    scale.low = -0.5;
    scale.high = static_cast<double>(axis.categories.size()) - 0.5;
    return scale;
  }
  if (!(low <= high)) low = axis.log ? 0.1 : 0.0, high = 1.0;
  if (axis.log) {
    scale.low = axis.min.value_or(std::pow(10.0, std::floor(std::log10(low) * 3.0) / 3.0));
    scale.high = axis.max.value_or(std::pow(10.0, std::ceil(std::log10(high) * 3.0) / 3.0));
    if (!(scale.high > scale.low)) scale.high = scale.low * 10.0;
    return scale;
  }
  if (axis.from_zero || bars) low = std::min(low, 0.0), high = std::max(high, 0.0);
  if (low == high) low -= 0.5, high += 0.5;
  const double pad = 0.04 * (high - low);
  scale.low = axis.min.value_or((axis.from_zero || bars) && low == 0.0 ? 0.0 : low - pad);
  scale.high = axis.max.value_or(high + pad);
  if (!(scale.high > scale.low)) scale.high = scale.low + 1.0;
  return scale;
}

std::vector<Tick> axis_ticks(const ChartAxis& axis, const AxisScale& scale, int target) {
  std::vector<Tick> ticks;
  if (!axis.categories.empty()) {
    for (std::size_t i = 0; i < axis.categories.size(); ++i)
      ticks.push_back({static_cast<double>(i), axis.categories[i]});
    return ticks;
  }
  if (scale.log) {
    const double decades = std::log10(scale.high / scale.low);
    for (double power = std::floor(std::log10(scale.low)); power <= std::log10(scale.high); power += 1.0) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit != 1.0 && decades > 2.5) continue;
        const double value = digit * std::pow(10.0, power);
        if (value >= scale.low * 0.9999 && value <= scale.high * 1.0001) ticks.push_back({value, log_label(value)});
      }
    }
    return ticks;
  }
  const std::vector<double> values = nice_ticks(scale.low, scale.high, target);
  const int decimals = values.size() > 1 ? decimals_for(values[1] - values[0]) : 3;
  for (const double v : values) ticks.push_back({v, plain_number(v, decimals)});
  return ticks;
}

void make_equal(AxisScale& x, AxisScale& y, double width_px, double height_px) {
  const double per_px = std::max((x.high - x.low) / width_px, (y.high - y.low) / height_px);
  const auto widen = [&](AxisScale& axis, double px) {
    const double extra = per_px * px - (axis.high - axis.low);
    axis.low -= extra / 2.0;
    axis.high += extra / 2.0;
  };
  widen(x, width_px);
  widen(y, height_px);
}

}  // namespace phasescan
