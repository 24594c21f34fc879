#include "slam/place_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "core/random.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan::place_spectrum_test {
namespace {

// sqrt(|F|) by the definition.
double slow(const std::vector<double>& image, std::size_t v, std::size_t u) {
  constexpr std::size_t n = PlaceSpectrum::kSize;
  std::complex<double> sum;
  for (std::size_t row = 0; row < n; ++row) {
    for (std::size_t col = 0; col < n; ++col) {
      if (image[row * n + col] == 0.0) continue;
      sum += image[row * n + col] * std::polar(1.0, -kTwoPi * static_cast<double>((u * col + v * row) % n) / n);
    }
  }
  return std::sqrt(std::abs(sum));
}

TEST(PlaceSpectrum, IsTheSlowTransform) {
  constexpr std::size_t n = PlaceSpectrum::kSize;
  PlaceSpectrum spectrum;
  Random random(5);
  for (int run = 0; run < 2; ++run) {  // the second finds the buffers used
    std::vector<double> image(n * n, 0.0);
    spectrum.clear();
    for (int k = 0; k < 60; ++k) {
      const std::size_t row = random.below(n), col = random.below(n);
      const double value = random.uniform(0.1, 1.0);
      image[row * n + col] = value;
      spectrum.pixel(row, col) = static_cast<float>(value);
    }
    const std::vector<float>& got = spectrum.root_magnitudes();
    ASSERT_EQ(got.size(), n * PlaceSpectrum::kHalf);
    for (int k = 0; k < 400; ++k) {
      const std::size_t v = random.below(n), u = k < 40 ? (k % 2) * (n / 2) : random.below(PlaceSpectrum::kHalf);
      // The square root makes much of a little near zero.
      const double expected = slow(image, v, u), found = static_cast<double>(got[v * PlaceSpectrum::kHalf + u]);
      EXPECT_NEAR(found * found, expected * expected, 2e-5) << v << " " << u;
    }
  }
}

}  // namespace
}  // namespace phasescan::place_spectrum_test
