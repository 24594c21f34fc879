#include "fft_icp/image/rasterize.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "support/rooms.hpp"

namespace phasescan::rasterize_test {
namespace {

ScanPoints points_at(std::initializer_list<std::pair<float, float>> list) {
  ScanPoints points;
  int beam = 0;
  for (const auto& [x, y] : list) {
    points.x.push_back(x);
    points.y.push_back(y);
    points.range.push_back(std::hypot(x, y));
    points.beam.push_back(beam);
    beam += 10;  // no neighbours
  }
  return points;
}

double sum(const Image& image) {
  return std::accumulate(image.pixels().begin(), image.pixels().end(), 0.0);
}

TEST(Rasterize, ColumnsAreXRowsAreYAndTheSensorIsTheCentre) {
  Rasterizer rasterizer;
  Image image;
  const ImageGrid grid{64, 3.2};  // 10 px per metre
  EXPECT_EQ(rasterizer.draw(points_at({{1.05F, 0.05F}, {0.05F, -2.05F}}), 0.0, grid, image), 2);
  EXPECT_EQ(image.at(32, 42), 1.0F);
  EXPECT_EQ(image.at(32 - 21, 32), 1.0F);
  EXPECT_EQ(sum(image), 2.0);
}

TEST(Rasterize, APixelCountsOnceAndPointsBeyondDmaxAreLeftOut) {
  Rasterizer rasterizer;
  Image image;
  EXPECT_EQ(rasterizer.draw(points_at({{1.01F, 0.01F}, {1.02F, 0.02F}, {3.3F, 0.0F}}), 0.0, {64, 3.2}, image), 1);
  EXPECT_EQ(sum(image), 1.0);
}

TEST(Rasterize, TurningThePointsTurnsThePicture) {
  Rasterizer rasterizer;
  Image image;
  rasterizer.draw(points_at({{1.05F, 0.05F}}), kPi / 2, {64, 3.2}, image);
  EXPECT_EQ(image.at(42, 31), 1.0F);  // (-0.05, 1.05)
}

TEST(Rasterize, ABlurKeepsTheSumAndTheCentreOfMass) {
  Rasterizer rasterizer(0.8);
  Image image;
  const ImageGrid grid{64, 3.2};
  rasterizer.draw(points_at({{1.0375F, -0.4125F}}), 0.0, grid, image);
  EXPECT_NEAR(sum(image), 1.0, 1e-5);
  double x = 0.0, y = 0.0;
  for (int r = 0; r < 64; ++r) {
    for (int c = 0; c < 64; ++c) {
      x += (c + 0.5) * static_cast<double>(image.at(r, c));
      y += (r + 0.5) * static_cast<double>(image.at(r, c));
    }
  }
  EXPECT_NEAR(x / 10.0 - 3.2, 1.0375, 0.013);  // an eighth of a pixel
  EXPECT_NEAR(y / 10.0 - 3.2, -0.4125, 0.013);
}

TEST(Rasterize, NeighbouringHitsAreJoinedButNotAcrossAGap) {
  ScanPoints points = points_at({{1.0F, -0.3F}, {1.0F, 0.1F}, {2.5F, 0.3F}});
  points.beam = {4, 5, 6};
  Image joined, alone;
  const int apart = Rasterizer(0.0, 0.0).draw(points, 0.0, {64, 3.2}, alone);
  const int together = Rasterizer(0.0, 0.5).draw(points, 0.0, {64, 3.2}, joined);
  EXPECT_EQ(apart, 3);
  EXPECT_EQ(together, 3 + 3);  // three pixels between the first two, none to the third
  points.beam = {4, 9, 20};
  EXPECT_EQ(Rasterizer(0.0, 0.5).draw(points, 0.0, {64, 3.2}, joined), 3);
  points.beam = {20, 9, 4};  // listed clockwise
  EXPECT_EQ(Rasterizer(0.0, 0.5).draw(points, 0.0, {64, 3.2}, joined), 3);
}

TEST(Rasterize, AWideHallIsShownWhole) {
  ScanPoints points;
  for (int i = 0; i < 100; ++i) {
    points.x.push_back(20.0F);
    points.y.push_back(0.0F);
    points.range.push_back(20.0F);
    points.beam.push_back(i);
  }
  std::vector<float> scratch;
  ImageOptions options;
  options.adaptive_factor = 1.1;
  EXPECT_NEAR(choose_grid(points, options, 128, scratch).dmax_m, 22.0, 1e-5);
  options.adaptive_factor = 0.0;
  EXPECT_EQ(choose_grid(points, options, 128, scratch).dmax_m, options.dmax_m);
}

}  // namespace
}  // namespace phasescan::rasterize_test
