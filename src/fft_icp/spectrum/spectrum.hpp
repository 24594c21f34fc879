/// Spectrum of a scan image and its magnitude ([Jiang19] Sec. 3.2).
#pragma once

#include "phasescan/fft_icp/options.hpp"
#include "fft_icp/image/image.hpp"
#include "fft_icp/spectrum/fft.hpp"

namespace phasescan {

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
