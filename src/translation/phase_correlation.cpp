#include "phasescan/translation/phase_correlation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<TranslationMode>() {
  static constexpr std::array<std::string_view, 4> kNames{"correlation-2d", "phase-2d", "projections", "projections-phase"};
  return kNames;
}

double parabola_peak(double left, double centre, double right) {
  const double curvature = left - 2.0 * centre + right;
  if (!(curvature < 0.0) || centre < left || centre < right) return 0.0;
  return 0.5 * (left - right) / curvature;
}

namespace {

RealFft make_fft(int size, bool two_dimensional) {
  return two_dimensional ? RealFft::image(size, size) : RealFft::rows(2, size);
}

/// out = a * conj(b), or a * b for the twin.
void multiply(const ComplexBuffer& a, const ComplexBuffer& b, bool twin, bool whiten, ComplexBuffer& out) {
  out.resize(a.size());
  const auto* pa = reinterpret_cast<const float*>(a.data());
  const auto* pb = reinterpret_cast<const float*>(b.data());
  auto* po = reinterpret_cast<float*>(out.data());
  const float sign = twin ? -1.0F : 1.0F;
  for (std::size_t i = 0; i < 2 * a.size(); i += 2) {
    const float br = pb[i], bi = sign * pb[i + 1];
    po[i] = pa[i] * br + pa[i + 1] * bi;
    po[i + 1] = pa[i + 1] * br - pa[i] * bi;
  }
  if (!whiten) return;
  for (auto& value : out) {
    const float length = std::abs(value);
    value = length > 0.0F ? value / length : std::complex<float>(0.0F, 0.0F);
  }
}

/// Index of the first highest value. Two passes, because finding a maximum vectorises and remembering where does not.
std::size_t highest(const float* data, std::size_t n) {
  float lanes[8];
  std::fill(std::begin(lanes), std::end(lanes), data[0]);
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    for (std::size_t k = 0; k < 8; ++k) lanes[k] = lanes[k] > data[i + k] ? lanes[k] : data[i + k];
  }
  float best = *std::max_element(std::begin(lanes), std::end(lanes));
  for (; i < n; ++i) best = std::max(best, data[i]);
  return static_cast<std::size_t>(std::find(data, data + n, best) - data);
}

int wrapped(int i, int n) { return (i % n + n) % n; }

/// A shift in [-n/2, n/2).
double unwrapped(double shift, int n) {
  if (shift >= 0.5 * n) return shift - n;
  return shift < -0.5 * n ? shift + n : shift;
}

}  // namespace

TranslationEstimator::TranslationEstimator(int size, const TranslationOptions& options)
    : size_(size),
      options_(options),
      two_dimensional_(options.mode == TranslationMode::kCorrelation2d || options.mode == TranslationMode::kPhase2d),
      whiten_(options.mode == TranslationMode::kPhase2d || options.mode == TranslationMode::kProjectionsPhase),
      fft_(make_fft(size, two_dimensional_)) {}

void TranslationEstimator::describe(const Image& image, TranslationSpectrum& out) {
  const auto n = static_cast<std::size_t>(size_);
  out.energy[0] = out.energy[1] = 0.0;
  if (two_dimensional_) {
    fft_.forward(image.pixels(), out.values);
    for (std::size_t r = 0; r < n; ++r) {
      const float* row = image.row(static_cast<int>(r));
      float lanes[4] = {0.0F, 0.0F, 0.0F, 0.0F};
      for (std::size_t c = 0; c < n; ++c) lanes[c % 4] += row[c] * row[c];
      out.energy[0] += static_cast<double>(lanes[0] + lanes[1] + lanes[2] + lanes[3]);
    }
    return;
  }
  // Projections onto x and y ([Jiang19] Eq. 22-25).
  projections_.assign(2 * n, 0.0F);
  for (std::size_t r = 0; r < n; ++r) {
    const float* row = image.row(static_cast<int>(r));
    for (std::size_t c = 0; c < n; ++c) {
      projections_[c] += row[c];
      projections_[n + r] += row[c];
    }
  }
  for (std::size_t i = 0; i < 2 * n; ++i) {
    out.energy[i / n] += static_cast<double>(projections_[i]) * static_cast<double>(projections_[i]);
  }
  fft_.forward(projections_, out.values);
}

TranslationPeak TranslationEstimator::peak(const TranslationSpectrum& reference, const TranslationSpectrum& scan, bool twin) {
  multiply(reference.values, scan.values, twin, whiten_, product_);
  fft_.inverse(product_, correlation_);
  const int n = size_;
  const double back = twin ? 1.0 : 0.0;
  const auto quality = [&](float value, int axis) {
    if (whiten_) return static_cast<double>(value);
    const double energy = std::sqrt(reference.energy[axis] * scan.energy[axis]);
    return energy > 0.0 ? static_cast<double>(value) / energy : 0.0;
  };
  const auto offset = [&](float left, float centre, float right) {
    return options_.subpixel ? parabola_peak(static_cast<double>(left), static_cast<double>(centre), static_cast<double>(right)) : 0.0;
  };
  TranslationPeak found;
  if (two_dimensional_) {
    const auto best = static_cast<int>(highest(correlation_.data(), correlation_.size()));
    const int row = best / n, col = best % n;
    const auto at = [&](int r, int c) { return correlation_[static_cast<std::size_t>(wrapped(r, n) * n + wrapped(c, n))]; };
    found.col = unwrapped(col + back + offset(at(row, col - 1), at(row, col), at(row, col + 1)), n);
    found.row = unwrapped(row + back + offset(at(row - 1, col), at(row, col), at(row + 1, col)), n);
    found.score = quality(at(row, col), 0);
    return found;
  }
  double score[2];
  for (int axis = 0; axis < 2; ++axis) {
    const float* line = correlation_.data() + axis * n;
    const auto best = static_cast<int>(highest(line, static_cast<std::size_t>(n)));
    const double shift = best + back + offset(line[wrapped(best - 1, n)], line[best], line[wrapped(best + 1, n)]);
    (axis == 0 ? found.col : found.row) = unwrapped(shift, n);
    score[axis] = quality(line[best], axis);
  }
  found.score = std::max(0.0, score[0]) * std::max(0.0, score[1]);
  return found;
}

}  // namespace phasescan
