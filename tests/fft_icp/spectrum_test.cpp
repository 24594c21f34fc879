#include "fft_icp/spectrum/spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fft_icp/image/rasterize.hpp"
#include "fft_icp/spectrum/polar.hpp"
#include "support/rooms.hpp"

namespace phasescan::spectrum_test {
namespace {

constexpr int kSize = 128;

Image room_image(double theta, double blur = 1.0) {
  ScanPoints points;
  scan_to_points(test::cast_room({}, 720), points);
  Image image;
  Rasterizer(blur, 0.5).draw(points, theta, {kSize, 6.0}, image);
  return image;
}

Image magnitude_of(const Image& image, MagnitudeScale scale = MagnitudeScale::kLinear) {
  ComplexBuffer spectrum;
  ImageTransform(kSize).forward(image, spectrum);
  Image out;
  magnitude(spectrum, kSize, scale, out);
  return out;
}

TEST(Spectrum, ShiftTheoremTheMagnitudeDoesNotMoveWithTheImage) {
  const Image image = room_image(0.0);
  Image shifted(kSize, kSize);
  for (int r = 0; r < kSize; ++r) {
    for (int c = 0; c < kSize; ++c) shifted.at((r + 17) % kSize, (c + 101) % kSize) = image.at(r, c);
  }
  const Image a = magnitude_of(image), b = magnitude_of(shifted);
  for (std::size_t i = 0; i < a.pixels().size(); ++i) ASSERT_NEAR(a.pixels()[i], b.pixels()[i], 1e-3) << i;
}

TEST(Spectrum, ZeroFrequencyIsInTheMiddleRowOfTheFirstColumn) {
  const Image image = room_image(0.0);
  double sum = 0.0;
  for (const float value : image.pixels()) sum += static_cast<double>(value);
  EXPECT_NEAR(magnitude_of(image).at(kSize / 2, 0), sum, 1e-2);
}

TEST(Spectrum, WallsAlongYHaveTheirEnergyAlongU) {
  Image image(kSize, kSize);
  for (int r = 0; r < kSize; ++r) image.at(r, 40) = 1.0F;  // a wall along y
  const Image m = magnitude_of(image);
  EXPECT_NEAR(m.at(kSize / 2, 20), kSize, 1e-2);
  EXPECT_NEAR(m.at(kSize / 2 + 20, 0), 0.0, 1e-2);
}

TEST(Polar, RotationTheoremTheRingsTurnWithTheImage) {
  const SpectrumOptions options;
  const PolarSampler sampler(kSize, options);
  const double turn = deg_to_rad(37.0);
  FloatBuffer a, b;
  sampler.sample(magnitude_of(room_image(0.0)), a);
  sampler.sample(magnitude_of(room_image(turn)), b);
  // b(phi + turn) = a(phi): correlate the inner half of the rings, where pixels matter little, at the true and at other
  // turns.
  const int bins = sampler.angle_bins(), rings = sampler.radii() / 2;
  const auto agreement = [&](int shift) {
    double sum = 0.0, aa = 0.0, bb = 0.0;
    for (int ring = 0; ring < rings; ++ring) {
      for (int t = 0; t < bins; ++t) {
        const auto x = static_cast<double>(a[static_cast<std::size_t>(ring * bins + t)]);
        const auto y = static_cast<double>(b[static_cast<std::size_t>(ring * bins + (t + shift) % bins)]);
        sum += x * y;
        aa += x * x;
        bb += y * y;
      }
    }
    return sum / std::sqrt(aa * bb);
  };
  EXPECT_GT(agreement(37), 0.97);
  for (const int wrong : {0, 20, 60, 90, 143}) EXPECT_LT(agreement(wrong), 0.9) << wrong;
}

TEST(Polar, ReadsAPlaneExactly) {
  Image plane(kSize, kSize / 2 + 1);
  for (int r = 0; r < plane.rows(); ++r) {
    for (int c = 0; c < plane.cols(); ++c)
      plane.at(r, c) = 2.0F * static_cast<float>(r - kSize / 2) + 3.0F * static_cast<float>(c);
  }
  const PolarSampler sampler(kSize, SpectrumOptions{});
  FloatBuffer out;
  sampler.sample(plane, out);
  for (int ring = 0; ring < sampler.radii(); ++ring) {
    for (int bin = 0; bin < sampler.angle_bins(); ++bin) {
      const double expected =
          sampler.radius(ring) * (2.0 * std::sin(sampler.angle(bin)) + 3.0 * std::cos(sampler.angle(bin)));
      ASSERT_NEAR(out[static_cast<std::size_t>(ring * sampler.angle_bins() + bin)], expected, 1e-3);
    }
  }
}

TEST(Polar, AMagnitudeOfAnotherSizeIsTheCallersMistake) {
  FloatBuffer out;
  EXPECT_THROW(PolarSampler(kSize, SpectrumOptions{}).sample(Image(64, 33), out), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::spectrum_test
