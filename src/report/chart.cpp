#include "report/chart.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/chart_plot.hpp"
#include "report/chart_scale.hpp"

namespace phasescan {
namespace {

constexpr double kTickText = 10.0;
constexpr double kLabelText = 11.0;
constexpr double kTitleText = 12.5;

void check_lengths(const Series& s) {
  const auto fits = [&](const std::vector<double>& v) { return v.empty() || v.size() == s.x.size(); };
  const bool y_may_be_empty = s.kind == SeriesKind::kBand;
  if ((s.y.size() != s.x.size() && !(y_may_be_empty && s.y.empty())) || !fits(s.low) || !fits(s.high) || !fits(s.q1) ||
      !fits(s.q3) || s.low.size() != s.high.size() || s.q1.size() != s.q3.size()) {
    throw std::invalid_argument("chart.series '" + s.name + "': x, y, low, high, q1, q3 differ in length");
  }
}

void draw_axes(SvgCanvas& canvas, const Chart& chart, const AxisScale& x, const AxisScale& y,
               const std::vector<Tick>& x_ticks, const std::vector<Tick>& y_ticks) {
  const Stroke grid{std::string(palette::kGrid), 1.0};
  const bool categories = !chart.x.categories.empty();
  const std::string muted(palette::kMuted);
  double widest = 0.0;
  for (const Tick& t : x_ticks) widest = std::max(widest, text_width(t.label, kTickText));
  const bool slanted = categories && widest > (x.px_high - x.px_low) / static_cast<double>(x_ticks.size()) - 3.0;
  for (const Tick& t : x_ticks) {
    const double px = x(t.value);
    if (chart.grid && !categories) canvas.line(px, y.px_low, px, y.px_high, grid);
    if (chart.frameless) continue;
    canvas.line(px, y.px_low, px, y.px_low + 3.5, {std::string(palette::kAxis), 1.0});
    if (slanted) {
      canvas.text(px + 4.0, y.px_low + 13.0, t.label, {kTickText, TextAnchor::kEnd, muted, false, 28.0});
    } else {
      canvas.text(px, y.px_low + 15.0, t.label, {kTickText, TextAnchor::kMiddle, muted});
    }
  }
  for (const Tick& t : y_ticks) {
    const double px = y(t.value);
    if (chart.grid) canvas.line(x.px_low, px, x.px_high, px, grid);
    if (chart.frameless) continue;
    canvas.line(x.px_low - 3.5, px, x.px_low, px, {std::string(palette::kAxis), 1.0});
    canvas.text(x.px_low - 6.0, px + 3.5, t.label, {kTickText, TextAnchor::kEnd, muted});
  }
}

std::vector<LegendEntry> legend_entries(const Chart& chart, const std::vector<std::string>& colors) {
  std::vector<LegendEntry> entries;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    if (chart.series[i].name.empty()) continue;
    const Series& s = chart.series[i];
    LegendEntry entry{s.name, {}};
    entry.look.kind = s.kind;
    entry.look.color = colors[i];
    entry.look.width = s.width;
    entry.look.dash = s.dash;
    entry.look.opacity = s.opacity;
    entry.look.marker = s.marker;
    entry.look.marker_size = s.marker_size;
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<std::string> series_colors(const Chart& chart) {
  std::vector<std::string> colors;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const std::string& own = chart.series[i].color;
    colors.push_back(own.empty() ? std::string(palette::cycle(i)) : own);
  }
  return colors;
}

void draw_inner_legend(SvgCanvas& canvas, const Chart& chart, const std::vector<LegendEntry>& entries,
                       const AxisScale& x, const AxisScale& y) {
  double widest = 0.0;
  for (const LegendEntry& e : entries) widest = std::max(widest, text_width(e.name, kTickText));
  const double w = widest + 40.0, h = 15.0 * static_cast<double>(entries.size()) + 8.0;
  const bool right = chart.legend == LegendPlace::kTopRight || chart.legend == LegendPlace::kBottomRight;
  const bool top = chart.legend == LegendPlace::kTopRight || chart.legend == LegendPlace::kTopLeft;
  const double x0 = right ? x.px_high - w - 6.0 : x.px_low + 6.0;
  const double y0 = top ? y.px_high + 6.0 : y.px_low - h - 6.0;
  canvas.rect(x0, y0, w, h, "#ffffff", 0.88, {std::string(palette::kGrid), 1.0});
  for (std::size_t i = 0; i < entries.size(); ++i) {
    draw_legend(&canvas, {entries[i]}, x0 + 4.0, y0 + 3.0 + 15.0 * static_cast<double>(i), 1e9);
  }
}

}  // namespace

void Chart::draw(SvgCanvas& canvas, double x0, double y0, double w, double h) const {
  for (const Series& s : series) check_lengths(s);
  const std::vector<std::string> colors = series_colors(*this);
  const std::vector<LegendEntry> entries =
      legend == LegendPlace::kNone ? std::vector<LegendEntry>{} : legend_entries(*this, colors);

  AxisScale sx = axis_limits(x, series, false), sy = axis_limits(y, series, true);
  const double title_height = (title.empty() ? 0.0 : 19.0) + (subtitle.empty() ? 0.0 : 15.0);
  const double legend_height = legend == LegendPlace::kBelow ? draw_legend(nullptr, entries, 0.0, 0.0, w - 20.0) : 0.0;
  const double top = y0 + 8.0 + title_height;
  double tick_depth = frameless ? 6.0 : 20.0;
  double widest_category = 0.0;
  for (const std::string& c : x.categories) widest_category = std::max(widest_category, text_width(c, kTickText));
  const double bottom_fixed = (x.label.empty() ? 0.0 : 17.0) + legend_height + 4.0;
  const int y_target = std::max(2, static_cast<int>(h / 45.0)), x_target = std::max(2, static_cast<int>(w / 70.0));
  double tick_width = 0.0;
  for (const Tick& t : axis_ticks(y, sy, y_target)) tick_width = std::max(tick_width, text_width(t.label, kTickText));
  const double left = x0 + (frameless ? 8.0 : tick_width + 14.0) + (y.label.empty() ? 0.0 : 17.0);
  const double right = x0 + w - 12.0;
  if (!x.categories.empty() && widest_category > (right - left) / static_cast<double>(x.categories.size()) - 3.0) {
    tick_depth += 0.47 * widest_category;
  }
  const double bottom = y0 + h - bottom_fixed - tick_depth;
  if (!(right > left + 10.0 && bottom > top + 10.0)) throw std::invalid_argument("chart.size: too small to draw in");
  if (equal) make_equal(sx, sy, right - left, bottom - top);
  sx.px_low = left, sx.px_high = right;
  sy.px_low = bottom, sy.px_high = top;

  canvas.rect(left, top, right - left, bottom - top, "#ffffff");
  if (raster) {
    const double px0 = sx(x.min.value_or(sx.low)), px1 = sx(x.max.value_or(sx.high));
    const double py0 = sy(y.max.value_or(sy.high)), py1 = sy(y.min.value_or(sy.low));
    canvas.pixels(px0, py0, px1 - px0, py1 - py0, raster->values, raster->rows, raster->cols, raster->color,
                  raster->levels);
  }
  draw_axes(canvas, *this, sx, sy, axis_ticks(x, sx, x_target), axis_ticks(y, sy, y_target));
  canvas.begin_clip(left, top, right - left, bottom - top);
  Plotter plotter(canvas, sx, sy, !x.categories.empty(), series);
  for (std::size_t i = 0; i < series.size(); ++i) plotter.draw(series[i], colors[i]);
  for (const ChartNote& note : notes) canvas.text(sx(note.x), sy(note.y), note.text, note.style);
  canvas.end_clip();
  canvas.rect(left, top, right - left, bottom - top, "none", 1.0, {std::string(palette::kAxis), 1.0});

  if (!title.empty())
    canvas.text(left, y0 + 17.0, title, {kTitleText, TextAnchor::kStart, std::string(palette::kInk), true});
  if (!subtitle.empty()) {
    canvas.text(left, y0 + (title.empty() ? 15.0 : 32.0), subtitle,
                {kTickText, TextAnchor::kStart, std::string(palette::kMuted)});
  }
  if (!x.label.empty()) {
    canvas.text((left + right) / 2.0, bottom + tick_depth + 11.0, x.label, {kLabelText, TextAnchor::kMiddle});
  }
  if (!y.label.empty()) {
    canvas.text(x0 + 13.0, (top + bottom) / 2.0, y.label,
                {kLabelText, TextAnchor::kMiddle, std::string(palette::kInk), false, 90.0});
  }
  if (legend == LegendPlace::kBelow) {
    draw_legend(&canvas, entries, x0 + 10.0, y0 + h - legend_height, w - 20.0);
  } else if (!entries.empty()) {
    draw_inner_legend(canvas, *this, entries, sx, sy);
  }
}

std::string Chart::svg(double w, double h) const {
  SvgCanvas canvas(w, h);
  draw(canvas, 0.0, 0.0, w, h);
  return canvas.str(title);
}

std::string Figure::svg() const {
  const int cols = std::max(1, std::min(columns, static_cast<int>(charts.size())));
  const int rows = (static_cast<int>(charts.size()) + cols - 1) / cols;
  std::vector<LegendEntry> entries;
  for (const Chart& chart : charts) {
    if (!shared_legend || chart.legend == LegendPlace::kNone) continue;
    for (LegendEntry& entry : legend_entries(chart, series_colors(chart))) {
      const bool known =
          std::any_of(entries.begin(), entries.end(), [&](const LegendEntry& e) { return e.name == entry.name; });
      if (!known) entries.push_back(std::move(entry));
    }
  }
  const double width = cols * cell_width;
  const double title_height = title.empty() ? 0.0 : 28.0;
  const double legend_height = draw_legend(nullptr, entries, 0.0, 0.0, width - 20.0);
  SvgCanvas canvas(width, std::max(1, rows) * cell_height + title_height + legend_height + 2.0);
  if (!title.empty()) canvas.text(10.0, 20.0, title, {14.0, TextAnchor::kStart, std::string(palette::kInk), true});
  for (std::size_t i = 0; i < charts.size(); ++i) {
    Chart chart = charts[i];
    if (shared_legend) chart.legend = LegendPlace::kNone;
    const int index = static_cast<int>(i);
    chart.draw(canvas, (index % cols) * cell_width, title_height + (index / cols) * cell_height, cell_width,
               cell_height);
  }
  draw_legend(&canvas, entries, 10.0, canvas.height() - legend_height, width - 20.0);
  return canvas.str(title);
}

}  // namespace phasescan
