#include "slam/place_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "phasescan/core/angle.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kSize = PlaceSpectrum::kSize, kHalf = PlaceSpectrum::kHalf;

/// A row of values, real and imaginary parts apart.
struct Row {
  float *re, *im;
};

/// One butterfly of four, times the three turning factors, for all lanes.
void butterfly(const Row (&x)[4], const Row (&y)[4], const float (&c)[3], const float (&s)[3], std::size_t lanes) {
  for (std::size_t l = 0; l < lanes; ++l) {
    const float ar = x[0].re[l] + x[2].re[l], ai = x[0].im[l] + x[2].im[l];
    const float br = x[0].re[l] - x[2].re[l], bi = x[0].im[l] - x[2].im[l];
    const float cr = x[1].re[l] + x[3].re[l], ci = x[1].im[l] + x[3].im[l];
    // i (x1 - x3)
    const float dr = x[3].im[l] - x[1].im[l], di = x[1].re[l] - x[3].re[l];
    const float pr = br - dr, pi = bi - di, qr = ar - cr, qi = ai - ci, rr = br + dr, ri = bi + di;
    y[0].re[l] = ar + cr;
    y[0].im[l] = ai + ci;
    y[1].re[l] = c[0] * pr - s[0] * pi;
    y[1].im[l] = c[0] * pi + s[0] * pr;
    y[2].re[l] = c[1] * qr - s[1] * qi;
    y[2].im[l] = c[1] * qi + s[1] * qr;
    y[3].re[l] = c[2] * rr - s[2] * ri;
    y[3].im[l] = c[2] * ri + s[2] * rr;
  }
}

}  // namespace

PlaceSpectrum::PlaceSpectrum() : root_(kSize * kHalf) {
  for (auto* part : {&re_, &im_, &re_to_, &im_to_}) part->assign(kSize * kLanes, 0.0F);
  for (std::size_t k = 0; k < kSize; ++k) {
    const double angle = -kTwoPi * static_cast<double>(k) / kSize;
    cos_.push_back(static_cast<float>(std::cos(angle)));
    sin_.push_back(static_cast<float>(std::sin(angle)));
  }
}

void PlaceSpectrum::clear() {
  std::fill(re_.begin(), re_.end(), 0.0F);
  std::fill(im_.begin(), im_.end(), 0.0F);
}

// Stockham's FFT, in order: three passes of radix 4, one of radix 2; all lanes at once.
void PlaceSpectrum::transform() {
  std::size_t stride = 1;
  for (std::size_t n = kSize; n > 2; n /= 4, stride *= 4) {
    const std::size_t quarter = n / 4;
    for (std::size_t p = 0; p < quarter; ++p) {
      const float c[3] = {cos_[p * stride], cos_[2 * p * stride], cos_[3 * p * stride]};
      const float s[3] = {sin_[p * stride], sin_[2 * p * stride], sin_[3 * p * stride]};
      for (std::size_t q = 0; q < stride; ++q) {
        Row x[4], y[4];
        for (std::size_t k = 0; k < 4; ++k) {
          const std::size_t from = (q + stride * (p + k * quarter)) * kLanes, to = (q + stride * (4 * p + k)) * kLanes;
          x[k] = {re_.data() + from, im_.data() + from};
          y[k] = {re_to_.data() + to, im_to_.data() + to};
        }
        butterfly(x, y, c, s, kLanes);
      }
    }
    std::swap(re_, re_to_);
    std::swap(im_, im_to_);
  }
  constexpr std::size_t half = kSize / 2 * kLanes;
  for (auto [from, to] : {std::pair{&re_, &re_to_}, std::pair{&im_, &im_to_}}) {
    const float* in = from->data();
    float* out = to->data();
    for (std::size_t k = 0; k < half; ++k) {
      out[k] = in[k] + in[k + half];
      out[k + half] = in[k] - in[k + half];
    }
    std::swap(*from, *to);
  }
}

const std::vector<float>& PlaceSpectrum::root_magnitudes() {
  transform();  // along the rows, two rows as one complex number
  // The spectra of both rows, and row and column change places.
  for (std::size_t l = 0; l < kSize / 2; ++l) {
    for (std::size_t u = 0; u < kHalf; ++u) {
      const std::size_t at = u * kLanes + l, mirrored = (kSize - u) % kSize * kLanes + l;
      const float re = re_[at], im = im_[at], other_re = re_[mirrored], other_im = im_[mirrored];
      const std::size_t even = 2 * l * kLanes + u, odd = even + kLanes;
      re_to_[even] = 0.5F * (re + other_re);
      im_to_[even] = 0.5F * (im - other_im);
      re_to_[odd] = 0.5F * (im + other_im);
      im_to_[odd] = 0.5F * (other_re - re);
    }
  }
  std::swap(re_, re_to_);
  std::swap(im_, im_to_);
  transform();
  for (std::size_t v = 0; v < kSize; ++v) {
    const float *re = re_.data() + v * kLanes, *im = im_.data() + v * kLanes;
    float* out = root_.data() + v * kHalf;
    for (std::size_t u = 0; u < kHalf; ++u) out[u] = std::sqrt(std::sqrt(re[u] * re[u] + im[u] * im[u]));
  }
  return root_;
}

}  // namespace phasescan
