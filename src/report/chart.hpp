/// Line, point, bar and box charts with axes and a legend, drawn as SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/svg.hpp"

namespace phasescan {

/// What a series looks like.
enum class SeriesKind {
  kLine,    ///< polyline, with markers where `marker` is not kNone
  kPoints,  ///< markers
  kDots,    ///< many small round dots (points of scans)
  kBars,    ///< one bar per x; series of one chart stand side by side
  kBoxes,   ///< one box per x: whiskers low..high, box q1..q3, line at y
  kBand,    ///< filled area between low and high
};

/// One set of data. x and y of one length; low and high are empty or of that length (whiskers: intervals).
struct Series {
  SeriesKind kind = SeriesKind::kLine;
  std::string name;  ///< empty: not in the legend
  std::vector<double> x, y;
  std::vector<double> low = {}, high = {};  ///< whisker ends (kBars, kPoints, kLine), band edges or whiskers of boxes
  std::vector<double> q1 = {}, q3 = {};     ///< kBoxes
  std::string color = {};                   ///< empty: the next of the palette
  double width = 1.6;                       ///< of the line, or diameter of a dot [px]
  std::string dash = {};
  double opacity = 1.0;
  Marker marker = Marker::kNone;
  double marker_size = 6.5;
};

/// One axis. Without limits they come from the data; with categories x = 0, 1, ... are their places.
struct ChartAxis {
  std::string label;
  std::optional<double> min, max;
  bool log = false;        ///< decades; values must be positive
  bool from_zero = false;  ///< limits from the data, but with 0 inside
  std::vector<std::string> categories;
};

/// Text at a place of the data.
struct ChartNote {
  double x, y;
  std::string text;
  TextStyle style;
};

enum class LegendPlace { kNone, kBelow, kTopRight, kTopLeft, kBottomRight, kBottomLeft };

/// A chart. Fill the fields, then draw it.
struct Chart {
  std::string title;
  std::string subtitle;
  ChartAxis x, y;
  std::vector<Series> series;
  std::vector<ChartNote> notes;
  LegendPlace legend = LegendPlace::kBelow;
  bool equal = false;  ///< one unit is as long on x as on y
  bool grid = true;
  bool frameless = false;  ///< no ticks and labels, only the frame
  /// Grey levels behind everything, row 0 on top, stretched over the limits of the axes (which must be given).
  struct Raster {
    std::vector<float> values;
    int rows = 0, cols = 0;
    std::string color = std::string(palette::kInk);
    int levels = 1;
  };
  std::optional<Raster> raster;

  /// Draws into the box (x0, y0, w, h) of the canvas.
  /// @throws std::invalid_argument naming the series whose vectors differ in length.
  void draw(SvgCanvas& canvas, double x0, double y0, double w, double h) const;
  /// A whole document of one chart.
  std::string svg(double w = 520.0, double h = 340.0) const;
};

/// Charts in a grid with one title and one legend for all: every name once, as the first chart that has it draws it.
struct Figure {
  std::string title;
  std::vector<Chart> charts;  ///< row by row
  int columns = 2;
  double cell_width = 330.0;
  double cell_height = 270.0;
  bool shared_legend = true;

  std::string svg() const;
};

/// Ticks at round numbers covering [low, high]: 1, 2 or 5 times a power of ten apart, about `target` of them.
std::vector<double> nice_ticks(double low, double high, int target);

/// One name of a legend with what it stands for.
struct LegendEntry {
  std::string name;
  Series look;
};
/// Legend in rows no wider than `width`; returns its height. Draws nothing without a canvas.
double draw_legend(SvgCanvas* canvas, const std::vector<LegendEntry>& entries, double x, double y, double width);

/// Colour and marker that a method has in every figure; others get one of the palette by `index`.
std::string method_color(std::string_view method, std::size_t index = 0);
Marker method_marker(std::string_view method, std::size_t index = 0);

}  // namespace phasescan
