#include <algorithm>
#include <array>
#include <utility>

#include "report/chart.hpp"

namespace phasescan {
namespace {

constexpr double kText = 10.5;
constexpr double kRow = 17.0;
constexpr double kSample = 22.0;

void draw_sample(SvgCanvas& canvas, const Series& look, double x, double y) {
  const double middle = x + kSample / 2.0;
  switch (look.kind) {
    case SeriesKind::kLine:
      canvas.line(x + 1.0, y, x + kSample - 1.0, y, {look.color, look.width, look.dash, look.opacity});
      canvas.marker(middle, y, look.marker, look.marker_size, look.color);
      break;
    case SeriesKind::kPoints:
      canvas.marker(middle, y, look.marker == Marker::kNone ? Marker::kCircle : look.marker, look.marker_size,
                    look.color);
      break;
    case SeriesKind::kDots:
      canvas.marker(middle, y, Marker::kCircle, 5.0, look.color);
      break;
    case SeriesKind::kBars:
      canvas.rect(x + 4.0, y - 5.0, 14.0, 10.0, look.color, look.opacity);
      break;
    case SeriesKind::kBoxes:
      canvas.rect(x + 4.0, y - 5.0, 14.0, 10.0, look.color, 0.3, {look.color, 1.2});
      break;
    case SeriesKind::kBand:
      canvas.rect(x + 4.0, y - 5.0, 14.0, 10.0, look.color, look.opacity < 1.0 ? look.opacity : 0.2);
      break;
  }
}

struct MethodLook {
  std::string_view method;
  std::string_view color;
  Marker marker;
};

const MethodLook* find_look(std::string_view method) {
  static constexpr std::array<MethodLook, 6> kLooks{{{"icp", palette::kBlue, Marker::kCircle},
                                                     {"ndt", palette::kOrange, Marker::kTriangle},
                                                     {"fft", palette::kGreen, Marker::kSquare},
                                                     {"fft-icp1", palette::kPurple, Marker::kDiamond},
                                                     {"fft-icp2", palette::kVermillion, Marker::kTriangleDown},
                                                     {"global", palette::kBlack, Marker::kCross}}};
  const auto found =
      std::find_if(kLooks.begin(), kLooks.end(), [&](const MethodLook& look) { return look.method == method; });
  return found == kLooks.end() ? nullptr : &*found;
}

}  // namespace

double draw_legend(SvgCanvas* canvas, const std::vector<LegendEntry>& entries, double x, double y, double width) {
  if (entries.empty()) return 0.0;
  double at = 0.0, row = 0.0;
  for (const LegendEntry& entry : entries) {
    const double entry_width = kSample + 5.0 + text_width(entry.name, kText) + 14.0;
    if (at > 0.0 && at + entry_width > width) at = 0.0, row += 1.0;
    if (canvas) {
      const double middle = y + row * kRow + kRow / 2.0;
      draw_sample(*canvas, entry.look, x + at, middle - 0.5);
      canvas->text(x + at + kSample + 5.0, middle + 3.5, entry.name, {kText});
    }
    at += entry_width;
  }
  return (row + 1.0) * kRow + 5.0;
}

std::string method_color(std::string_view method, std::size_t index) {
  const MethodLook* look = find_look(method);
  return std::string(look ? look->color : palette::cycle(index + 5));
}

Marker method_marker(std::string_view method, std::size_t index) {
  const MethodLook* look = find_look(method);
  static constexpr std::array<Marker, 4> kOther{Marker::kCircle, Marker::kSquare, Marker::kDiamond, Marker::kTriangle};
  return look ? look->marker : kOther[index % kOther.size()];
}

}  // namespace phasescan
