#include "refine/nearest_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace phasescan::nearest_grid_test {
namespace {

std::vector<SurfacePoint> random_points(Random& random, int count, double half_width) {
  std::vector<SurfacePoint> points(static_cast<std::size_t>(count));
  for (SurfacePoint& p : points) {
    p.x = static_cast<float>(random.uniform(-half_width, half_width));
    p.y = static_cast<float>(random.uniform(-half_width, half_width));
  }
  return points;
}

TEST(NearestGrid, AnswersAreAsNearAsCellsCanTell) {
  Random random(5);
  const float cell = 0.1F;
  for (const int count : {1, 10, 300}) {
    const auto points = random_points(random, count, 3.0);
    NearestGrid grid;
    grid.build(points, 3.0F, cell);
    for (int k = 0; k < 2000; ++k) {
      const auto x = static_cast<float>(random.uniform(-4, 4)), y = static_cast<float>(random.uniform(-4, 4));
      float best = 1e9F;
      for (const SurfacePoint& p : points) best = std::min(best, std::hypot(p.x - x, p.y - y));
      const int found = grid.nearest(x, y);
      // Both ends are rounded to cells: half a diagonal each, twice.
      if (found >= 0) {
        EXPECT_LE(
            std::hypot(points[static_cast<std::size_t>(found)].x - x, points[static_cast<std::size_t>(found)].y - y),
            best + 3.0F * cell);
      } else {
        EXPECT_GT(best, (NearestGrid::kReachCells - 1) * cell);
      }
    }
  }
}

TEST(NearestGrid, BuiltAgainItAnswersAsANewOne) {
  // Large for its points, so that what was written last time is cleared and not the whole; growing and shrinking.
  Random random(6);
  NearestGrid again;
  for (const double half_width : {20.0, 20.03, 19.2, 20.4, 30.0, 12.0, 2.0, 12.0}) {
    const auto points = random_points(random, 60, half_width);
    NearestGrid fresh;
    fresh.build(points, static_cast<float>(half_width), 0.1F);
    again.build(points, static_cast<float>(half_width), 0.1F);
    for (int k = 0; k < 20000; ++k) {
      const auto x = static_cast<float>(random.uniform(-32, 32)), y = static_cast<float>(random.uniform(-32, 32));
      ASSERT_EQ(again.nearest(x, y), fresh.nearest(x, y)) << half_width << " " << x << " " << y;
    }
  }
}

TEST(NearestGrid, PointsOutsideAndNonsensePositionsAreHarmless) {
  std::vector<SurfacePoint> points(3);
  points[0].x = 100.0F;
  points[1].y = -100.0F;
  NearestGrid grid;
  grid.build(points, 1.0F, 0.1F);
  EXPECT_EQ(grid.nearest(0.0F, 0.0F), 2);
  for (const float bad : {1e30F, -1e30F, std::nanf("")}) {
    EXPECT_EQ(grid.nearest(bad, 0.0F), -1);
    EXPECT_EQ(grid.nearest(0.0F, bad), -1);
  }
}

}  // namespace
}  // namespace phasescan::nearest_grid_test
