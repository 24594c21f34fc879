/// Spectrum of a scan image and its magnitude ([Jiang19] Sec. 3.2).
#pragma once

#include "phasescan/core/options.hpp"
#include "image/image.hpp"
#include "spectrum/fft.hpp"

namespace phasescan {

/// Taper of the image before its FFT.
enum class ImageWindow { kNone, kHann };
template <>
std::span<const std::string_view> enum_names<ImageWindow>();

/// What is kept of a magnitude.
enum class MagnitudeScale { kLinear, kSqrt, kLog };
template <>
std::span<const std::string_view> enum_names<MagnitudeScale>();

/// Section `spectrum`. The paper says nothing on window, scale or which radii are read.
struct SpectrumOptions {
  ImageWindow window = ImageWindow::kNone;
  MagnitudeScale magnitude = MagnitudeScale::kLinear;
  int angle_bins = 180;
  int radii = 32;
  double radius_min = 0.04;
  double radius_max = 0.75;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("window", self.window, OptionInfo{"", "taper of the image before its FFT for the rotation: none or hann"});
    v("magnitude", self.magnitude, OptionInfo{"", "linear, sqrt or log"});
    v("angle_bins", self.angle_bins, OptionInfo{"", "samples over 180 degrees of a polar ring", 16, 4096, true});
    v("radii", self.radii, OptionInfo{"", "rings of the polar grid", 1, 1024});
    v("radius_min", self.radius_min, OptionInfo{"", "innermost ring, as a share of the Nyquist frequency", 0, 1});
    v("radius_max", self.radius_max,
      OptionInfo{"", "outermost ring, as a share of the Nyquist frequency", 0, 1, false, "radius_min"});
  }
};

/// The FFT of square images of one size, with an optional window. One object per thread.
class ImageTransform {
 public:
  explicit ImageTransform(int size, ImageWindow window = ImageWindow::kNone);

  int size() const { return size_; }
  /// Half spectrum, size x (size/2 + 1), of the tapered image.
  void forward(const Image& image, ComplexBuffer& out);
  /// Back to a size x size image; destroys `spectrum`.
  void inverse(ComplexBuffer& spectrum, FloatBuffer& out) { fft_.inverse(spectrum, out); }

 private:
  int size_;
  RealFft fft_;
  std::vector<float> taper_;  ///< empty without a window
  FloatBuffer tapered_;
};

/// |F(v, u)| of a half spectrum, rows ordered from v = -size/2 to size/2 - 1, columns from u = 0 to size/2.
/// It does not move with the image, and turns with it. @cost O(size^2)
void magnitude(const ComplexBuffer& half_spectrum, int size, MagnitudeScale scale, Image& out);

}  // namespace phasescan
