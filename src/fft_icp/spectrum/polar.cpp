#include "fft_icp/spectrum/polar.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

PolarSampler::PolarSampler(int size, const SpectrumOptions& options)
    : angle_bins_(options.angle_bins), radii_(options.radii), stride_(size / 2 + 1) {
  // One frequency is left free at the rim, so that bilinear reading stays inside.
  const double nyquist = size / 2.0, rim = nyquist - 1.0;
  radius_min_ = std::min(std::max(1.0, options.radius_min * nyquist), rim);
  const double outer = std::min(std::max(radius_min_, options.radius_max * nyquist), rim);
  radius_step_ = radii_ > 1 ? (outer - radius_min_) / (radii_ - 1) : 0.0;
  taps_.reserve(static_cast<std::size_t>(radii_) * static_cast<std::size_t>(angle_bins_));
  for (int ring = 0; ring < radii_; ++ring) {
    for (int bin = 0; bin < angle_bins_; ++bin) {
      // cos is never negative in this half turn; rounding may leave -1e-17.
      const double u = std::max(0.0, radius(ring) * std::cos(angle(bin)));
      const double v = radius(ring) * std::sin(angle(bin)) + nyquist;
      const double u0 = std::floor(u), v0 = std::floor(v);
      taps_.push_back({static_cast<std::int32_t>(v0) * stride_ + static_cast<std::int32_t>(u0),
                       static_cast<float>(u - u0), static_cast<float>(v - v0)});
    }
  }
}

double PolarSampler::angle(int bin) const {
  return -kPi / 2 + kPi * bin / angle_bins_;
}
double PolarSampler::radius(int ring) const {
  return radius_min_ + radius_step_ * ring;
}

void PolarSampler::sample(const Image& magnitude, FloatBuffer& out) const {
  if (magnitude.cols() != stride_ || magnitude.rows() != 2 * (stride_ - 1)) {
    throw std::invalid_argument("polar.magnitude: of another image size");
  }
  out.resize(taps_.size());
  const float* data = magnitude.pixels().data();
  for (std::size_t i = 0; i < taps_.size(); ++i) {
    const Tap& tap = taps_[i];
    const float* low = data + tap.at;
    const float* high = low + stride_;
    const float a = low[0] + tap.fu * (low[1] - low[0]), b = high[0] + tap.fu * (high[1] - high[0]);
    out[i] = a + tap.fv * (b - a);
  }
}

}  // namespace phasescan
