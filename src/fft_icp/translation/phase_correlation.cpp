#include "fft_icp/translation/phase_correlation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace phasescan {

double parabola_peak(double left, double centre, double right) {
  const double curvature = left - 2.0 * centre + right;
  if (!(curvature < 0.0) || centre < left || centre < right) return 0.0;
  return 0.5 * (left - right) / curvature;
}

namespace {

RealFft make_fft(int size, TranslationMode mode) {
  return mode == TranslationMode::kImage ? RealFft::image(size, size) : RealFft::rows(2, size);
}

/// out = a * conj(b), or a * b for the twin.
void multiply(const ComplexBuffer& a, const ComplexBuffer& b, bool twin, ComplexBuffer& out) {
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
}

/// x^(-1/4) to 1e-6, for positive x, without a division or a root: a first guess from the exponent bits, then Newton
/// steps. Vectorises, which a pair of square roots and a division do only badly.
inline float inverse_fourth_root(float x) {
  float y = std::bit_cast<float>(0x4F58CAE5U - (std::bit_cast<std::uint32_t>(x) >> 2));
  for (int step = 0; step < 3; ++step) {
    const float squared = y * y;
    y *= 1.25F - 0.25F * x * squared * squared;
  }
  return y;
}

/// Divides each coefficient by its magnitude to the power `whitening`.
void divide_by_magnitude(ComplexBuffer& values, double whitening) {
  // Far below anything an image of ones and zeros has: keeps a coefficient of 0 at 0.
  constexpr float kTiny = 1e-12F;
  constexpr std::size_t kBlock = 64;
  auto* v = reinterpret_cast<float*>(values.data());
  const auto power = static_cast<float>(-0.5 * whitening);
  float scale[kBlock];
  for (std::size_t from = 0; from < values.size(); from += kBlock) {
    const std::size_t n = std::min(kBlock, values.size() - from);
    float* block = v + 2 * from;
    for (std::size_t i = 0; i < n; ++i)
      scale[i] = block[2 * i] * block[2 * i] + block[2 * i + 1] * block[2 * i + 1] + kTiny;
    if (whitening == 0.5) {
      for (std::size_t i = 0; i < n; ++i) scale[i] = inverse_fourth_root(scale[i]);
    } else if (whitening == 1.0) {
      for (std::size_t i = 0; i < n; ++i) scale[i] = 1.0F / std::sqrt(scale[i]);
    } else {
      for (std::size_t i = 0; i < n; ++i) scale[i] = std::pow(scale[i], power);
    }
    for (std::size_t i = 0; i < n; ++i) {
      block[2 * i] *= scale[i];
      block[2 * i + 1] *= scale[i];
    }
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

int wrapped(int i, int n) {
  return (i % n + n) % n;
}

/// A shift in [-n/2, n/2).
double unwrapped(double shift, int n) {
  if (shift >= 0.5 * n) return shift - n;
  return shift < -0.5 * n ? shift + n : shift;
}

}  // namespace

TranslationEstimator::TranslationEstimator(int size, const TranslationOptions& options)
    : size_(size), options_(options), fft_(make_fft(size, options.mode)) {}

void TranslationEstimator::whiten(TranslationSpectrum& spectrum) const {
  if (options_.whitening > 0.0) divide_by_magnitude(spectrum.values, options_.whitening);
  // Parseval; columns 1 .. size/2 - 1 of a half spectrum stand for two coefficients each.
  const std::size_t half = static_cast<std::size_t>(size_) / 2 + 1, rows = spectrum.values.size() / half;
  const double samples = two_dimensional() ? static_cast<double>(size_) * size_ : size_;
  spectrum.energy[0] = spectrum.energy[1] = 0.0;
  for (std::size_t r = 0; r < rows; ++r) {
    const auto* row = reinterpret_cast<const float*>(spectrum.values.data() + r * half);
    float lanes[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= 2 * half; i += 8) {
      for (std::size_t k = 0; k < 8; ++k) lanes[k] += row[i + k] * row[i + k];
    }
    float sum = 0.0F;
    for (; i < 2 * half; ++i) sum += row[i] * row[i];
    for (const float lane : lanes) sum += lane;
    const double edges = static_cast<double>(row[0] * row[0] + row[1] * row[1] + row[2 * half - 2] * row[2 * half - 2] +
                                             row[2 * half - 1] * row[2 * half - 1]);
    spectrum.energy[two_dimensional() ? 0 : r] += (2.0 * static_cast<double>(sum) - edges) / samples;
  }
}

void TranslationEstimator::describe(const ComplexBuffer& half_spectrum, TranslationSpectrum& out) {
  out.values = half_spectrum;
  whiten(out);
}

void TranslationEstimator::describe(const Image& image, TranslationSpectrum& out) {
  if (two_dimensional()) {
    fft_.forward(image.pixels(), out.values);
  } else {
    // Projections onto x and y ([Jiang19] Eq. 22-25).
    const auto n = static_cast<std::size_t>(size_);
    projections_.assign(2 * n, 0.0F);
    for (std::size_t r = 0; r < n; ++r) {
      const float* row = image.row(static_cast<int>(r));
      for (std::size_t c = 0; c < n; ++c) projections_[c] += row[c];
      float lanes[4] = {0.0F, 0.0F, 0.0F, 0.0F};
      for (std::size_t c = 0; c + 4 <= n; c += 4) {
        for (std::size_t k = 0; k < 4; ++k) lanes[k] += row[c + k];
      }
      for (std::size_t c = n - n % 4; c < n; ++c) lanes[0] += row[c];
      projections_[n + r] = lanes[0] + lanes[1] + lanes[2] + lanes[3];
    }
    fft_.forward(projections_, out.values);
  }
  whiten(out);
}

TranslationPeak TranslationEstimator::peak(const TranslationSpectrum& reference, const TranslationSpectrum& scan,
                                           bool twin) {
  multiply(reference.values, scan.values, twin, product_);
  fft_.inverse(product_, correlation_);
  const int n = size_;
  const double back = twin ? 1.0 : 0.0;
  const auto quality = [&](float value, int axis) {
    const double energy = std::sqrt(reference.energy[axis] * scan.energy[axis]);
    return energy > 0.0 ? static_cast<double>(value) / energy : 0.0;
  };
  const auto offset = [&](float left, float centre, float right) {
    return options_.subpixel
               ? parabola_peak(static_cast<double>(left), static_cast<double>(centre), static_cast<double>(right))
               : 0.0;
  };
  TranslationPeak found;
  if (two_dimensional()) {
    const auto best = static_cast<int>(highest(correlation_.data(), correlation_.size()));
    const int row = best / n, col = best % n;
    const auto at = [&](int r, int c) {
      return correlation_[static_cast<std::size_t>(wrapped(r, n) * n + wrapped(c, n))];
    };
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
