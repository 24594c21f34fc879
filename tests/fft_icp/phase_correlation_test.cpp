#include "fft_icp/translation/phase_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"
#include "fft_icp/image/rasterize.hpp"
#include "support/rooms.hpp"

namespace phasescan::phase_correlation_test {
namespace {

constexpr int kSize = 64;

std::vector<TranslationOptions> all_modes() {
  std::vector<TranslationOptions> all;
  for (const TranslationMode mode : {TranslationMode::kImage, TranslationMode::kProjections}) {
    for (const double whitening : {0.0, 0.3, 0.5, 1.0}) {
      all.emplace_back();
      all.back().mode = mode;
      all.back().whitening = whitening;
    }
  }
  return all;
}

Image blobs(std::uint64_t seed) {
  Random random(seed);
  Image image(kSize, kSize);
  for (int i = 0; i < 60; ++i)
    image.at(static_cast<int>(random.below(kSize)), static_cast<int>(random.below(kSize))) = 1.0F;
  return image;
}

/// The image moved by (dx, dy), cyclically.
Image moved(const Image& image, int dx, int dy) {
  Image out(kSize, kSize);
  for (int r = 0; r < kSize; ++r) {
    for (int c = 0; c < kSize; ++c) out.at((r + dy + kSize) % kSize, (c + dx + kSize) % kSize) = image.at(r, c);
  }
  return out;
}

TEST(PhaseCorrelation, AnswersTheShiftThatTakesTheScanOntoTheReference) {
  for (const TranslationOptions& options : all_modes()) {
    TranslationEstimator estimator(kSize, options);
    const Image scan = blobs(1);
    for (const auto& [dx, dy] : {std::pair{5, -9}, {-20, 3}, {0, 0}, {31, -32}}) {
      TranslationSpectrum a, b;
      estimator.describe(moved(scan, dx, dy), a);
      estimator.describe(scan, b);
      const TranslationPeak peak = estimator.find(a, b);
      EXPECT_NEAR(peak.col, dx, 0.51) << to_string(options.mode) << options.whitening;
      EXPECT_NEAR(peak.row, dy, 0.51) << to_string(options.mode) << options.whitening;
      EXPECT_NEAR(peak.score, 1.0, 1e-3) << "a pure shift has quality 1";
    }
  }
}

TEST(PhaseCorrelation, TheTwinIsTheImageTurnedByHalfATurn) {
  for (const TranslationOptions& options : all_modes()) {
    TranslationEstimator estimator(kSize, options);
    const Image scan = blobs(2);
    Image turned(kSize, kSize);
    for (int r = 0; r < kSize; ++r) {
      for (int c = 0; c < kSize; ++c) turned.at(r, c) = scan.at(kSize - 1 - r, kSize - 1 - c);
    }
    TranslationSpectrum reference, plain, twin;
    estimator.describe(moved(turned, 7, -4), reference);
    estimator.describe(scan, plain);
    estimator.describe(turned, twin);
    const TranslationPeak fast = estimator.find_twin(reference, plain), slow = estimator.find(reference, twin);
    EXPECT_NEAR(fast.col, slow.col, 1e-3) << to_string(options.mode) << options.whitening;
    EXPECT_NEAR(fast.row, slow.row, 1e-3);
    EXPECT_NEAR(fast.score, slow.score, 1e-3);
    EXPECT_NEAR(fast.col, 7.0, 0.51);
    EXPECT_NEAR(fast.row, -4.0, 0.51);
  }
}

TEST(PhaseCorrelation, FindsFractionsOfAPixel) {
  TranslationEstimator estimator(kSize, TranslationOptions{});
  Rasterizer rasterizer(1.0);
  const ImageGrid grid{kSize, 3.2};  // 10 px per metre
  ScanPoints points;
  scan_to_points(test::cast_room({}, 180), points);
  for (float& range : points.range) range = 0.1F;  // all of it, wherever it moves
  Image image;
  TranslationSpectrum a, b;
  rasterizer.draw(points, 0.0, grid, image);
  estimator.describe(image, b);
  for (const float shift : {0.025F, 0.05F, 0.075F}) {
    ScanPoints away = points;
    for (float& x : away.x) x += shift;
    rasterizer.draw(away, 0.0, grid, image);
    estimator.describe(image, a);
    EXPECT_NEAR(estimator.find(a, b).col, 10.0 * static_cast<double>(shift), 0.2);
  }
}

TEST(PhaseCorrelation, UnrelatedImagesScoreLow) {
  TranslationEstimator estimator(kSize, TranslationOptions{});
  TranslationSpectrum a, b;
  estimator.describe(blobs(3), a);
  estimator.describe(blobs(4), b);
  EXPECT_LT(estimator.find(a, b).score, 0.5);
}

TEST(PhaseCorrelation, AnEmptyImageIsNoAnswerAndNoNan) {
  for (const TranslationOptions& options : all_modes()) {
    TranslationEstimator estimator(kSize, options);
    TranslationSpectrum a, b;
    estimator.describe(Image(kSize, kSize), a);
    estimator.describe(blobs(5), b);
    const TranslationPeak peak = estimator.find(a, b);
    EXPECT_TRUE(std::isfinite(peak.col) && std::isfinite(peak.row) && std::isfinite(peak.score));
  }
}

TEST(PhaseCorrelation, AParabolaPeaksWhereItShould) {
  const auto f = [](double x) { return 3.0 - 2.0 * (x - 0.3) * (x - 0.3); };
  EXPECT_NEAR(parabola_peak(f(-1), f(0), f(1)), 0.3, 1e-12);
  EXPECT_EQ(parabola_peak(1.0, 1.0, 1.0), 0.0);
  EXPECT_EQ(parabola_peak(2.0, 1.0, 2.0), 0.0);
}

}  // namespace
}  // namespace phasescan::phase_correlation_test
