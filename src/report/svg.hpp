/// A small SVG canvas: the few shapes that figures are made of, written as compact text that needs nothing else to be
/// shown.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace phasescan {

/// Colours of every figure: ink, greys, and the eight that colour-blind readers can tell apart [Okabe08].
namespace palette {
inline constexpr std::string_view kInk = "#1a1a1a";
inline constexpr std::string_view kMuted = "#5f6368";
inline constexpr std::string_view kAxis = "#80868b";
inline constexpr std::string_view kGrid = "#e3e5e8";
inline constexpr std::string_view kBlue = "#0072b2";
inline constexpr std::string_view kOrange = "#e69f00";
inline constexpr std::string_view kGreen = "#009e73";
inline constexpr std::string_view kPurple = "#b2679c";
inline constexpr std::string_view kVermillion = "#d55e00";
inline constexpr std::string_view kSky = "#56b4e9";
inline constexpr std::string_view kBlack = "#000000";
inline constexpr std::string_view kGrey = "#9aa0a6";
/// The i-th colour for things that have none of their own.
std::string_view cycle(std::size_t i);
}  // namespace palette

/// How a line is drawn. `dash` as SVG has it ("4 3"), empty = solid.
struct Stroke {
  std::string color = std::string(palette::kInk);
  double width = 1.0;
  std::string dash = {};
  double opacity = 1.0;
};

enum class TextAnchor { kStart, kMiddle, kEnd };

/// How text is drawn: size in px, turned counter-clockwise by `rotate_deg` about its anchor.
struct TextStyle {
  double size = 11.0;
  TextAnchor anchor = TextAnchor::kStart;
  std::string color = std::string(palette::kInk);
  bool bold = false;
  double rotate_deg = 0.0;
  bool halo = false;  ///< a white edge, to be read over data
};

/// Shapes of data points, so that figures can also be read in black and white.
enum class Marker { kNone, kCircle, kSquare, kTriangle, kDiamond, kCross, kTriangleDown };

/// Drawing surface, x right, y down, in px. Not finite coordinates break a polyline and leave out a point.
class SvgCanvas {
 public:
  /// @throws std::invalid_argument for a size that is not positive and finite.
  SvgCanvas(double width, double height);

  double width() const { return width_; }
  double height() const { return height_; }

  void line(double x1, double y1, double x2, double y2, const Stroke& stroke);
  void polyline(std::span<const double> x, std::span<const double> y, const Stroke& stroke);
  void polygon(std::span<const double> x, std::span<const double> y, std::string_view fill, double opacity = 1.0);
  void rect(double x, double y, double w, double h, std::string_view fill, double opacity = 1.0,
            const Stroke& stroke = {"none", 0.0});
  void circle(double x, double y, double radius, const Stroke& stroke);
  /// Many round dots of one colour in one element.
  void dots(std::span<const double> x, std::span<const double> y, double diameter, std::string_view color,
            double opacity = 1.0);
  void marker(double x, double y, Marker shape, double size, std::string_view color);
  void text(double x, double y, std::string_view content, const TextStyle& style = {});
  /// Row-major grey levels in [0, 1] (0 leaves the background) drawn as `levels` shades of `color` in the box; row 0 on
  /// top.
  void pixels(double x, double y, double w, double h, std::span<const float> values, int rows, int cols,
              std::string_view color, int levels = 1);
  /// Everything until end_clip() shows only inside the box.
  void begin_clip(double x, double y, double w, double h);
  void end_clip();
  /// Another canvas as a part of this one.
  void append(const SvgCanvas& part, double x, double y);

  /// The whole document. `title` is what screen readers say.
  std::string str(std::string_view title = {}) const;

 private:
  double width_;
  double height_;
  std::string body_;
};

/// Width of a text in px, estimated from its characters (good to some 10 % for the fonts in use).
double text_width(std::string_view content, double size);

/// Number with at most `decimals` places and no trailing zeros: "0.5", "12", "-3.25"; the minus of zero is dropped.
std::string plain_number(double value, int decimals);

/// &, <, >, " as XML entities; control characters dropped.
std::string xml_escape(std::string_view text);

}  // namespace phasescan
