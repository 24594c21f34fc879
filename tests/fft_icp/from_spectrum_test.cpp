#include "fft_icp/rotation/from_spectrum.hpp"

#include <gtest/gtest.h>

#include "fft_icp/image/rasterize.hpp"
#include "support/rooms.hpp"

namespace phasescan::from_spectrum_test {
namespace {

constexpr int kSize = 128;

std::vector<RotationCandidate> rotation_between(double turn, const RotationOptions& options, double noise = 0.0) {
  SpectralRotation rotation(kSize, SpectrumOptions{}, options);
  ImageTransform transform(kSize);
  Rasterizer rasterizer(0.8, 0.5);
  PolarDescriptor descriptor[2];
  for (int k = 0; k < 2; ++k) {
    ScanPoints points;
    // The scan's sensor is turned by `turn`, so its picture is turned back by it.
    scan_to_points(test::cast_room({0.3 * k, 0.2 * k, turn * k}, 360, noise, 0.02, 3), points);
    Image image;
    rasterizer.draw(points, 0.0, {kSize, 6.0}, image);
    ComplexBuffer spectrum;
    transform.forward(image, spectrum);
    rotation.describe(spectrum, descriptor[k]);
  }
  std::vector<RotationCandidate> out;
  rotation.candidates(descriptor[0], descriptor[1], out);
  return out;
}

TEST(SpectralRotation, FindsTheTurnUpToItsTwin) {
  for (const RotationMode mode : {RotationMode::kPerRadius, RotationMode::kRadiusSum}) {
    RotationOptions options;
    options.mode = mode;
    for (const double degrees : {-80.0, -33.0, 0.0, 12.0, 64.0, 120.0, 175.0}) {
      const auto found = rotation_between(deg_to_rad(degrees), options, 0.01);
      ASSERT_FALSE(found.empty());
      EXPECT_LT(0.5 * angle_distance(2.0 * found[0].theta, 2.0 * deg_to_rad(degrees)), deg_to_rad(1.5)) << degrees;
      EXPECT_LE(std::abs(found[0].theta), kPi / 2 + 1e-9);
      EXPECT_LE(found[0].score, 1.0 + 1e-4);
    }
  }
}

TEST(SpectralRotation, CandidatesAreBestFirstAndApart) {
  RotationOptions options;
  options.candidates = 4;
  options.separation_deg = 15.0;
  const auto found = rotation_between(0.4, options);
  ASSERT_GE(found.size(), 2U);
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_LE(found[i].score, found[i - 1].score);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GE(0.5 * angle_distance(2.0 * found[i].theta, 2.0 * found[k].theta), deg_to_rad(14.0));
    }
  }
}

TEST(SpectralRotation, AnEmptyImageHasNoRotation) {
  SpectralRotation rotation(kSize, SpectrumOptions{}, RotationOptions{});
  ComplexBuffer spectrum;
  ImageTransform(kSize).forward(Image(kSize, kSize), spectrum);
  PolarDescriptor descriptor;
  rotation.describe(spectrum, descriptor);
  std::vector<RotationCandidate> out;
  rotation.candidates(descriptor, descriptor, out);
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace phasescan::from_spectrum_test
