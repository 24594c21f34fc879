/// Draws the data of one chart, once its axes have their scales.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "report/chart_scale.hpp"

namespace phasescan {

/// Draws the series of one chart through two scales.
class Plotter {
 public:
  Plotter(SvgCanvas& canvas, const AxisScale& x, const AxisScale& y, bool categories, const std::vector<Series>& series)
      : canvas_(canvas), x_(x), y_(y) {
    for (const Series& s : series) columns_ += s.kind == SeriesKind::kBars || s.kind == SeriesKind::kBoxes;
    if (columns_ == 0 && categories) {
      dodge_points_ = true;
      for (const Series& s : series) columns_ += s.kind == SeriesKind::kPoints;
    }
  }

  void draw(const Series& s, const std::string& color) {
    switch (s.kind) {
      case SeriesKind::kLine:
        line(s, color);
        break;
      case SeriesKind::kPoints:
        points(s, color);
        break;
      case SeriesKind::kDots:
        canvas_.dots(to_px(s.x, x_), to_px(s.y, y_), s.width, color, s.opacity);
        break;
      case SeriesKind::kBars:
        bars(s, color);
        break;
      case SeriesKind::kBoxes:
        boxes(s, color);
        break;
      case SeriesKind::kBand:
        band(s, color);
        break;
    }
  }

 private:
  static std::vector<double> to_px(const std::vector<double>& values, const AxisScale& scale) {
    std::vector<double> out(values.size());
    std::transform(values.begin(), values.end(), out.begin(), scale);
    return out;
  }

  /// Centre of this series' column at x, and the column's width.
  double column_center(double x) const {
    const double width = column_width();
    return x_(x) + (column_ - (columns_ - 1) / 2.0) * width;
  }
  double column_width() const { return 0.8 * (x_(1.0) - x_(0.0)) / std::max(columns_, 1); }

  void whisker(double x, double low, double high, const Stroke& stroke, double cap) {
    if (!std::isfinite(low) || !std::isfinite(high)) return;
    const double a = y_(low), b = y_(high);
    canvas_.line(x, a, x, b, stroke);
    canvas_.line(x - cap, a, x + cap, a, stroke);
    canvas_.line(x - cap, b, x + cap, b, stroke);
  }

  void line(const Series& s, const std::string& color) {
    canvas_.polyline(to_px(s.x, x_), to_px(s.y, y_), {color, s.width, s.dash, s.opacity});
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!s.low.empty()) whisker(x_(s.x[i]), s.low[i], s.high[i], {color, 1.0, {}, 0.7}, 2.5);
      canvas_.marker(x_(s.x[i]), y_(s.y[i]), s.marker, s.marker_size, color);
    }
  }

  void points(const Series& s, const std::string& color) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const double x = dodge_points_ ? column_center(s.x[i]) : x_(s.x[i]);
      if (!s.low.empty()) whisker(x, s.low[i], s.high[i], {color, 1.2}, 3.0);
      canvas_.marker(x, y_(s.y[i]), s.marker == Marker::kNone ? Marker::kCircle : s.marker, s.marker_size, color);
    }
    if (dodge_points_) ++column_;
  }

  void bars(const Series& s, const std::string& color) {
    const double width = column_width();
    const double base = y_(std::clamp(0.0, y_.low, y_.high));
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.y[i])) continue;
      const double x = column_center(s.x[i]), top = y_(s.y[i]);
      canvas_.rect(x - 0.46 * width, std::min(top, base), 0.92 * width, std::abs(base - top), color, s.opacity);
      if (s.low.empty()) continue;
      whisker(x, s.low[i], s.high[i], {"#ffffff", 3.0, {}, 0.75},
              std::min(3.0, width / 4.0));  // so that it shows on dark bars
      whisker(x, s.low[i], s.high[i], {std::string(palette::kInk), 1.0}, std::min(3.0, width / 4.0));
    }
    ++column_;
  }

  void boxes(const Series& s, const std::string& color) {
    const double width = std::min(column_width(), 26.0);
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.y[i])) continue;
      const double x = column_center(s.x[i]);
      if (!s.low.empty()) whisker(x, s.low[i], s.high[i], {color, 1.2}, width / 5.0);
      if (!s.q1.empty()) {
        const double top = y_(s.q3[i]), bottom = y_(s.q1[i]);
        canvas_.rect(x - 0.36 * width, top, 0.72 * width, std::max(bottom - top, 0.5), "#ffffff");
        canvas_.rect(x - 0.36 * width, top, 0.72 * width, std::max(bottom - top, 0.5), color, 0.3, {color, 1.2});
      }
      canvas_.line(x - 0.36 * width, y_(s.y[i]), x + 0.36 * width, y_(s.y[i]), {color, 2.2});
    }
    ++column_;
  }

  void band(const Series& s, const std::string& color) {
    std::vector<double> x = to_px(s.x, x_), y = to_px(s.high, y_);
    const std::vector<double> back = to_px(s.low, y_);
    for (std::size_t i = back.size(); i-- > 0;) {
      x.push_back(x_(s.x[i]));
      y.push_back(back[i]);
    }
    canvas_.polygon(x, y, color, s.opacity < 1.0 ? s.opacity : 0.2);
  }

  SvgCanvas& canvas_;
  AxisScale x_, y_;
  int columns_ = 0;
  int column_ = 0;
  bool dodge_points_ = false;
};

}  // namespace phasescan
