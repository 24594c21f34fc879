#include "slam/keyframe_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/random.hpp"

namespace phasescan::keyframe_points_test {
namespace {

void push(MapPoints& points, float x, float y, float nx, float ny, float variance, float normal_variance, bool free) {
  points.x.push_back(x), points.y.push_back(y), points.nx.push_back(nx), points.ny.push_back(ny);
  points.variance.push_back(variance), points.normal_variance.push_back(normal_variance);
  points.free_standing.push_back(free);
  points.with_normal += nx != 0.0F || ny != 0.0F;
}

TEST(KeyframePoints, ComeBackAsNearAsSaid) {
  Random random(5);
  MapPoints points, back;
  for (int i = 0; i < 2000; ++i) {
    const double a = random.uniform(-kPi, kPi);
    const bool lone = i % 7 == 0;
    push(points, static_cast<float>(random.uniform(-12.0, 12.0)), static_cast<float>(random.uniform(-12.0, 12.0)),
         lone ? 0.0F : static_cast<float>(std::cos(a)), lone ? 0.0F : static_cast<float>(std::sin(a)),
         static_cast<float>(std::pow(10.0, random.uniform(-5.0, 0.0))),
         lone ? 0.0F : static_cast<float>(std::pow(10.0, random.uniform(-6.0, 0.0))), i % 11 == 0);
  }
  // Along the axes, where the code of a direction changes from one quadrant to the next.
  for (const auto& [nx, ny] : {std::pair{1.0F, 0.0F}, {0.0F, 1.0F}, {-1.0F, 0.0F}, {0.0F, -1.0F}, {0.0F, -0.0F}})
    push(points, 0.0F, -0.0F, nx, ny, 1e-4F, 1e-3F, false);
  const KeyframePoints kept(points);
  kept.unpack(back);
  ASSERT_EQ(back.size(), points.size());
  ASSERT_EQ(kept.size(), points.size());
  EXPECT_EQ(back.with_normal, points.with_normal);
  EXPECT_EQ(back.free_standing, points.free_standing);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(back.x[i], points.x[i], 2e-4F);
    EXPECT_NEAR(back.y[i], points.y[i], 2e-4F);
    EXPECT_EQ(back.lone(i), points.lone(i));
    EXPECT_NEAR(std::hypot(back.nx[i] - points.nx[i], back.ny[i] - points.ny[i]), 0.0F, 1e-4F) << i;
    EXPECT_NEAR(back.variance[i], points.variance[i], 0.01F * points.variance[i]);
    EXPECT_NEAR(back.normal_variance[i], points.normal_variance[i], 0.01F * points.normal_variance[i]);
  }
}

TEST(KeyframePoints, NoneAndOneAtTheOriginAndHugeVariances) {
  MapPoints points, back;
  KeyframePoints(points).unpack(back);
  EXPECT_EQ(back.size(), 0u);
  push(points, 0.0F, 0.0F, 0.0F, 0.0F, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity(), true);
  KeyframePoints(points).unpack(back);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back.x[0], 0.0F);
  EXPECT_FALSE(std::isnan(back.variance[0]));
  EXPECT_FALSE(std::isnan(back.normal_variance[0]));
  EXPECT_EQ(back.free_standing[0], 1);
}

}  // namespace
}  // namespace phasescan::keyframe_points_test
