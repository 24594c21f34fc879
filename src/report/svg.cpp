#include "report/svg.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

std::string px(double value) {
  return plain_number(value, 2);
}

std::string stroke_attributes(const Stroke& stroke) {
  std::string out = fmt::format(R"( stroke="{}" stroke-width="{}")", stroke.color, px(stroke.width));
  if (!stroke.dash.empty()) out += fmt::format(R"( stroke-dasharray="{}")", stroke.dash);
  if (stroke.opacity < 1.0) out += fmt::format(R"( stroke-opacity="{}")", px(stroke.opacity));
  return out;
}

std::string fill_opacity(double opacity) {
  return opacity < 1.0 ? fmt::format(R"( fill-opacity="{}")", px(opacity)) : std::string();
}

/// Corners of a marker around (0, 0) for size 1; empty for a circle.
std::span<const std::array<double, 2>> marker_corners(Marker shape) {
  using Corner = std::array<double, 2>;
  static constexpr std::array<Corner, 4> kSquare{{{-.45, -.45}, {.45, -.45}, {.45, .45}, {-.45, .45}}};
  static constexpr std::array<Corner, 3> kTriangle{{{0, -.58}, {.55, .42}, {-.55, .42}}};
  static constexpr std::array<Corner, 3> kTriangleDown{{{0, .58}, {.55, -.42}, {-.55, -.42}}};
  static constexpr std::array<Corner, 4> kDiamond{{{0, -.62}, {.55, 0}, {0, .62}, {-.55, 0}}};
  static constexpr std::array<Corner, 12> kCross{{{-.15, -.5},
                                                  {.15, -.5},
                                                  {.15, -.15},
                                                  {.5, -.15},
                                                  {.5, .15},
                                                  {.15, .15},
                                                  {.15, .5},
                                                  {-.15, .5},
                                                  {-.15, .15},
                                                  {-.5, .15},
                                                  {-.5, -.15},
                                                  {-.15, -.15}}};
  switch (shape) {
    case Marker::kSquare:
      return kSquare;
    case Marker::kTriangle:
      return kTriangle;
    case Marker::kTriangleDown:
      return kTriangleDown;
    case Marker::kDiamond:
      return kDiamond;
    case Marker::kCross:
      return kCross;
    default:
      return {};
  }
}

}  // namespace

std::string_view palette::cycle(std::size_t i) {
  static constexpr std::array<std::string_view, 8> kColors{kBlue,   kVermillion, kGreen, kOrange,
                                                           kPurple, kSky,        kBlack, kGrey};
  return kColors[i % kColors.size()];
}

std::string plain_number(double value, int decimals) {
  std::string out = fmt::format("{:.{}f}", value, decimals);
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

std::string xml_escape(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') out += c;
    }
  }
  return out;
}

double text_width(std::string_view content, double size) {
  double em = 0.0;
  for (const char c : content) {
    const auto u = static_cast<unsigned char>(c);
    if ((u & 0xc0) == 0x80) continue;  // continuation byte of UTF-8
    if (c == 'i' || c == 'l' || c == 'j' || c == '.' || c == ',' || c == ':' || c == '|' || c == '\'') {
      em += 0.28;
    } else if (c == 'm' || c == 'w' || c == 'M' || c == 'W' || c == '%') {
      em += 0.88;
    } else if (c == ' ' || c == 'f' || c == 't' || c == 'r' || c == '(' || c == ')' || c == '-') {
      em += 0.36;
    } else {
      em += (c >= 'A' && c <= 'Z') ? 0.69 : 0.58;
    }
  }
  return em * size;
}

SvgCanvas::SvgCanvas(double width, double height) : width_(width), height_(height) {
  if (!(width > 0.0 && height > 0.0 && std::isfinite(width) && std::isfinite(height))) {
    throw std::invalid_argument("svg.size: width and height must be positive and finite");
  }
}

void SvgCanvas::line(double x1, double y1, double x2, double y2, const Stroke& stroke) {
  const double x[]{x1, x2};
  const double y[]{y1, y2};
  polyline(x, y, stroke);
}

void SvgCanvas::polyline(std::span<const double> x, std::span<const double> y, const Stroke& stroke) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      pen_down = false;
      continue;
    }
    fmt::format_to(std::back_inserter(path), "{}{} {}", pen_down ? 'L' : 'M', px(x[i]), px(y[i]));
    pen_down = true;
  }
  if (path.empty()) return;
  body_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\"{}/>\n", path, stroke_attributes(stroke));
}

void SvgCanvas::polygon(std::span<const double> x, std::span<const double> y, std::string_view fill, double opacity) {
  std::string path;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    fmt::format_to(std::back_inserter(path), "{}{} {}", path.empty() ? 'M' : 'L', px(x[i]), px(y[i]));
  }
  if (path.empty()) return;
  body_ += fmt::format("<path d=\"{}Z\" fill=\"{}\"{}/>\n", path, fill, fill_opacity(opacity));
}

void SvgCanvas::rect(double x, double y, double w, double h, std::string_view fill, double opacity,
                     const Stroke& stroke) {
  body_ += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}"{})", px(x), px(y), px(w), px(h), fill,
                       fill_opacity(opacity));
  if (stroke.width > 0.0) body_ += stroke_attributes(stroke);
  body_ += "/>\n";
}

void SvgCanvas::circle(double x, double y, double radius, const Stroke& stroke) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\"{}/>\n", px(x), px(y), px(radius),
                       stroke_attributes(stroke));
}

void SvgCanvas::dots(std::span<const double> x, std::span<const double> y, double diameter, std::string_view color,
                     double opacity) {
  std::string path;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    fmt::format_to(std::back_inserter(path), "M{} {}h0", px(x[i]), px(y[i]));
  }
  if (path.empty()) return;
  body_ += fmt::format("<path d=\"{}\" stroke-linecap=\"round\" fill=\"none\"{}/>\n", path,
                       stroke_attributes({std::string(color), diameter, {}, opacity}));
}

void SvgCanvas::marker(double x, double y, Marker shape, double size, std::string_view color) {
  if (shape == Marker::kNone || !std::isfinite(x) || !std::isfinite(y)) return;
  if (shape == Marker::kCircle) {
    body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\"/>\n", px(x), px(y), px(size / 2.0), color);
    return;
  }
  std::vector<double> xs, ys;
  for (const auto& corner : marker_corners(shape)) {
    xs.push_back(x + size * corner[0]);
    ys.push_back(y + size * corner[1]);
  }
  polygon(xs, ys, color);
}

void SvgCanvas::text(double x, double y, std::string_view content, const TextStyle& style) {
  body_ += fmt::format(R"(<text x="{}" y="{}" font-size="{}" fill="{}")", px(x), px(y), px(style.size), style.color);
  if (style.anchor == TextAnchor::kMiddle) body_ += R"( text-anchor="middle")";
  if (style.anchor == TextAnchor::kEnd) body_ += R"( text-anchor="end")";
  if (style.halo) body_ += R"( stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke")";
  if (style.bold) body_ += R"( font-weight="bold")";
  if (style.rotate_deg != 0.0)
    body_ += fmt::format(" transform=\"rotate({} {} {})\"", px(-style.rotate_deg), px(x), px(y));
  body_ += fmt::format(">{}</text>\n", xml_escape(content));
}

void SvgCanvas::pixels(double x, double y, double w, double h, std::span<const float> values, int rows, int cols,
                       std::string_view color, int levels) {
  if (rows < 1 || cols < 1 || levels < 1 ||
      values.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols)) {
    throw std::invalid_argument("svg.pixels: the values do not fill rows x cols, or levels < 1");
  }
  const auto level_of = [&](int row, int col) {
    const double v =
        values[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col)];
    return v > 0.0 ? static_cast<int>(std::ceil(std::min(v, 1.0) * levels)) : 0;
  };
  const double dx = w / cols, dy = h / rows;
  std::vector<std::string> paths(static_cast<std::size_t>(levels) + 1);
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols;) {
      const int level = level_of(row, col);
      int end = col + 1;
      while (end < cols && level_of(row, end) == level) ++end;
      if (level > 0) {
        fmt::format_to(std::back_inserter(paths[static_cast<std::size_t>(level)]), "M{} {}h{}v{}h{}z", px(x + dx * col),
                       px(y + dy * row), px(dx * (end - col)), px(dy), px(-dx * (end - col)));
      }
      col = end;
    }
  }
  for (int level = 1; level <= levels; ++level) {
    const std::string& path = paths[static_cast<std::size_t>(level)];
    if (path.empty()) continue;
    body_ += fmt::format("<path d=\"{}\" fill=\"{}\"{} shape-rendering=\"crispEdges\"/>\n", path, color,
                         fill_opacity(static_cast<double>(level) / levels));
  }
}

void SvgCanvas::begin_clip(double x, double y, double w, double h) {
  // A nested viewport clips without an id, so that several figures can share one HTML page.
  body_ += fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n", px(x),
                       px(y), px(w), px(h));
}

void SvgCanvas::end_clip() {
  body_ += "</svg>\n";
}

void SvgCanvas::append(const SvgCanvas& part, double x, double y) {
  body_ += fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n", px(x), px(y), part.body_);
}

std::string SvgCanvas::str(std::string_view title) const {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n",
      px(width_), px(height_));
  if (!title.empty()) out += fmt::format("<title>{}</title>\n", xml_escape(title));
  out += fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n", px(width_), px(height_));
  return out + body_ + "</svg>\n";
}

}  // namespace phasescan
