/// The spectrum of a small image: an FFT of one size, so that place search needs no library for it.
#pragma once

#include <cstddef>
#include <vector>

namespace phasescan {

/// The 2-D FFT of real images of kSize x kSize pixels. One object per thread; allocates nothing after construction.
/// Plain sums and products of floats, nothing fused: the same bits on every CPU.
class PlaceSpectrum {
 public:
  static constexpr std::size_t kSize = 128, kHalf = kSize / 2 + 1;

  PlaceSpectrum();

  /// Makes every pixel 0.
  void clear();
  float& pixel(std::size_t row, std::size_t col) {
    std::vector<float>& part = row % 2 == 0 ? re_ : im_;
    return part[col * kLanes + row / 2];
  }

  /// sqrt(|F(v, u)|), F(v, u) = sum pixel(row, col) exp(-2 pi i (u col + v row) / kSize), for v = 0 .. kSize - 1 and
  /// u = 0 .. kSize / 2, row-major; the pixels are lost.
  /// @cost about 60 us
  const std::vector<float>& root_magnitudes();

 private:
  static constexpr std::size_t kLanes = 80;  ///< transforms side by side: kHalf of them, to whole vectors

  void transform();

  // Value k of transform l is at [k * kLanes + l]. Before the first pass: of column k the rows 2 l and 2 l + 1.
  std::vector<float> re_, im_, re_to_, im_to_;
  std::vector<float> cos_, sin_;  ///< of -2 pi k / kSize
  std::vector<float> root_;
};

}  // namespace phasescan
