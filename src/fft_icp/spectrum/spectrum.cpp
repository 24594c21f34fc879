#include "fft_icp/spectrum/spectrum.hpp"

#include <array>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

ImageTransform::ImageTransform(int size, ImageWindow window) : size_(size), fft_(RealFft::image(size, size)) {
  if (window == ImageWindow::kNone) return;
  for (int i = 0; i < size; ++i) {
    taper_.push_back(static_cast<float>(0.5 - 0.5 * std::cos(kTwoPi * (i + 0.5) / size)));
  }
}

void ImageTransform::forward(const Image& image, ComplexBuffer& out) {
  if (taper_.empty()) {
    fft_.forward(image.pixels(), out);
    return;
  }
  tapered_ = image.pixels();
  const auto n = static_cast<std::size_t>(size_);
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < n; ++c) tapered_[r * n + c] *= taper_[r] * taper_[c];
  }
  fft_.forward(tapered_, out);
}

void magnitude(const ComplexBuffer& half_spectrum, int size, MagnitudeScale scale, Image& out) {
  const int half = size / 2 + 1;
  if (out.rows() != size || out.cols() != half) out.resize(size, half);
  for (int row = 0; row < size; ++row) {
    const int source = (row + size / 2) % size;  // row 0 is v = -size/2
    const auto* in = reinterpret_cast<const float*>(half_spectrum.data() + static_cast<std::ptrdiff_t>(source) * half);
    float* to = out.row(row);
    for (int u = 0; u < half; ++u) to[u] = std::sqrt(in[2 * u] * in[2 * u] + in[2 * u + 1] * in[2 * u + 1]);
    if (scale == MagnitudeScale::kSqrt) {
      for (int u = 0; u < half; ++u) to[u] = std::sqrt(to[u]);
    } else if (scale == MagnitudeScale::kLog) {
      for (int u = 0; u < half; ++u) to[u] = std::log1p(to[u]);
    }
  }
}

}  // namespace phasescan
