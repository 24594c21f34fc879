#include "slam/place_spectrum.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "slam/place_spectrum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::CappedTag<float, 16> kF;  // PlaceSpectrum::kLanes is a multiple of 16
using V = hn::Vec<decltype(kF)>;

// One butterfly of four, times the three turning factors, for all lanes; the four parts of x are `from` apart, those of
// y are `to` apart.
void Butterfly(const float* HWY_RESTRICT re, const float* HWY_RESTRICT im, std::size_t from, float* HWY_RESTRICT to_re,
               float* HWY_RESTRICT to_im, std::size_t to, const float (&c)[3], const float (&s)[3], std::size_t lanes) {
  const auto turned = [&](int k, V x, V y, std::size_t at) {
    const V cosine = hn::Set(kF, c[k]), sine = hn::Set(kF, s[k]);
    hn::StoreU(hn::Sub(hn::Mul(cosine, x), hn::Mul(sine, y)), kF, to_re + at);
    hn::StoreU(hn::Add(hn::Mul(cosine, y), hn::Mul(sine, x)), kF, to_im + at);
  };
  for (std::size_t l = 0; l < lanes; l += hn::Lanes(kF)) {
    const V r0 = hn::LoadU(kF, re + l), r1 = hn::LoadU(kF, re + from + l), r2 = hn::LoadU(kF, re + 2 * from + l),
            r3 = hn::LoadU(kF, re + 3 * from + l);
    const V i0 = hn::LoadU(kF, im + l), i1 = hn::LoadU(kF, im + from + l), i2 = hn::LoadU(kF, im + 2 * from + l),
            i3 = hn::LoadU(kF, im + 3 * from + l);
    const V ar = hn::Add(r0, r2), ai = hn::Add(i0, i2), br = hn::Sub(r0, r2), bi = hn::Sub(i0, i2);
    const V cr = hn::Add(r1, r3), ci = hn::Add(i1, i3);
    const V dr = hn::Sub(i3, i1), di = hn::Sub(r1, r3);  // i (x1 - x3)
    hn::StoreU(hn::Add(ar, cr), kF, to_re + l);
    hn::StoreU(hn::Add(ai, ci), kF, to_im + l);
    turned(0, hn::Sub(br, dr), hn::Sub(bi, di), to + l);
    turned(1, hn::Sub(ar, cr), hn::Sub(ai, ci), 2 * to + l);
    turned(2, hn::Add(br, dr), hn::Add(bi, di), 3 * to + l);
  }
}

// Sums and differences of the two halves.
void LastPass(const float* HWY_RESTRICT in, std::size_t half, float* HWY_RESTRICT out) {
  for (std::size_t k = 0; k < half; k += hn::Lanes(kF)) {
    const V a = hn::LoadU(kF, in + k), b = hn::LoadU(kF, in + k + half);
    hn::StoreU(hn::Add(a, b), kF, out + k);
    hn::StoreU(hn::Sub(a, b), kF, out + k + half);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>
#include <utility>

#include "phasescan/core/pose2.hpp"

namespace phasescan {
HWY_EXPORT(Butterfly);
HWY_EXPORT(LastPass);

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
        const std::size_t from = (q + stride * p) * kLanes, to = (q + stride * 4 * p) * kLanes;
        HWY_DYNAMIC_DISPATCH(Butterfly)
        (re_.data() + from, im_.data() + from, stride * quarter * kLanes, re_to_.data() + to, im_to_.data() + to,
         stride * kLanes, c, s, kLanes);
      }
    }
    std::swap(re_, re_to_);
    std::swap(im_, im_to_);
  }
  for (auto [from, to] : {std::pair{&re_, &re_to_}, std::pair{&im_, &im_to_}}) {
    HWY_DYNAMIC_DISPATCH(LastPass)(from->data(), kSize / 2 * kLanes, to->data());
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
#endif
