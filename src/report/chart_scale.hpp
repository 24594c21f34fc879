/// From data to px: limits and ticks of the two axes of one chart.
#pragma once

#include <string>
#include <vector>

#include "report/chart.hpp"

namespace phasescan {

/// Limits of one axis and where it lies on the canvas.
struct AxisScale {
  double low = 0.0, high = 1.0;
  double px_low = 0.0, px_high = 1.0;
  bool log = false;

  double operator()(double value) const;
  bool covers(double value) const { return value >= low && value <= high; }
};

struct Tick {
  double value;
  std::string label;
};

/// Limits of an axis from its own fields and the data of all series along it.
AxisScale axis_limits(const ChartAxis& axis, const std::vector<Series>& series, bool is_y);

/// Ticks with labels; `target` = about how many.
std::vector<Tick> axis_ticks(const ChartAxis& axis, const AxisScale& scale, int target);

/// Widens one of the two axes so that a unit is equally long on both.
void make_equal(AxisScale& x, AxisScale& y, double width_px, double height_px);

}  // namespace phasescan
