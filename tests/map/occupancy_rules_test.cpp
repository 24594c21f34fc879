// What a single beam or cell may say, rule by rule.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "map/occupancy_grid.hpp"
#include "map/view_rays.hpp"

namespace phasescan::occupancy_rules_test {
namespace {

constexpr Pose2 kInCell{0.05, 0.05, 0.0};  // the middle of cell (0, 0)

OccupancyOptions ten_cm() {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  return options;
}

Scan beams(const std::vector<float>& ranges, double angle_min, double increment, double range_min = 0.0) {
  return make_scan(ranges, {angle_min, increment, range_min, 0.0});
}

TEST(OccupancyRules, ABeamThatIsInvalidOrEndsTooNearSaysNothing) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), 0.02F}) {
    OccupancyGrid grid(ten_cm());
    grid.add_scan(beams({2.0F, bad, 3.0F}, -0.3, 0.3, 0.1), kInCell);
    EXPECT_FALSE(grid.known(10, 0)) << bad;
  }
}

TEST(OccupancyRules, AMissingBeamNeedsHitsWithinFiveBeamsOnBothSides) {
  for (const int apart : {5, 6}) {
    std::vector<float> ranges(static_cast<std::size_t>(2 * apart + 1), 0.0F);
    ranges.front() = ranges.back() = 2.0F;
    OccupancyGrid grid(ten_cm());
    grid.add_scan(beams(ranges, -0.1 * apart, 0.1), kInCell);
    EXPECT_EQ(grid.known(10, 0), apart == 5);
  }
}

TEST(OccupancyRules, ARayIsDrawnNoFartherThanTheLongestAndAHitBeyondIsLeftOut) {
  OccupancyOptions options = ten_cm();
  options.max_ray_m = 3.0;
  OccupancyGrid grid(options);
  grid.add_scan(beams({5.0F}, 0.0, 0.1), kInCell);
  EXPECT_LT(grid.log_odds(28, 0), 0.0);
  EXPECT_FALSE(grid.known(32, 0));
  EXPECT_FALSE(grid.known(50, 0));
}

TEST(OccupancyRules, EachBeamStartsWhereTheLaserWasByThen) {
  // Two beams straight ahead, one second apart, of a laser that moves 1 m a second to the left.
  Scan scan = beams({2.0F, 2.0F}, 0.0, 1e-4);
  scan.time_increment = 1.0;
  OccupancyGrid grid(ten_cm());
  grid.add_scan(scan, kInCell, {0.0, 1.0, 0.0});
  EXPECT_GT(grid.log_odds(20, 0), 0.0);
  EXPECT_GT(grid.log_odds(20, 10), 0.0);
  EXPECT_FALSE(grid.known(20, 5));
}

TEST(OccupancyRules, ACellIsHitOncePerScanHoweverManyBeamsEndInIt) {
  OccupancyGrid grid(ten_cm());
  grid.add_scan(beams({1.0F, 1.0F, 1.0F}, 0.0, 0.01), kInCell);
  EXPECT_NEAR(grid.log_odds(10, 0), 0.9, 1e-9);
}

TEST(OccupancyRules, BoundsHoldOnTheEdgesOfTiles) {
  for (const int i : {-65, -64, -63, -1, 0, 63, 64}) {
    OccupancyGrid grid(ten_cm());
    grid.add_scan(beams({0.01F}, 0.0, 0.1), {0.1 * i + 0.05, 0.1 * i + 0.05, 0.0});
    const OccupancyGrid::Bounds b = grid.bounds();
    EXPECT_TRUE(b.min_i == i && b.max_i == i && b.min_k == i && b.max_k == i) << i;
  }
}

TEST(OccupancyRules, WhatIsBarelyOccupiedStopsNoRayAndIsNoWall) {
  OccupancyGrid grid(ten_cm());
  grid.add_scan(beams({1.0F}, 0.0, 0.1), kInCell);
  grid.add_scan(beams({2.0F}, 0.0, 0.1), kInCell);
  ASSERT_NEAR(grid.log_odds(10, 0), 0.5, 1e-9);
  const auto found = grid.raycast({0.05, 0.05}, 0.0, 5.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1.95, 1e-9);
  const TrinaryMap map = make_trinary(grid, 0);
  EXPECT_EQ(map.at(10, 0), CellState::kUnknown) << "one hit, one ray through: a probability of 0.62";
  EXPECT_EQ(map.at(15, 0), CellState::kUnknown) << "a single ray: 0.40";
  EXPECT_EQ(map.at(20, 0), CellState::kOccupied);
  EXPECT_EQ(map.at(5, 0), CellState::kUnknown) << "two rays: 0.31";
}

TEST(ViewRays, ABeamMeetsALineAheadThatItDoesNotGraze) {
  const MapLine line;  // along x
  const auto ray = [](double angle) {
    ViewRay r;
    r.from = {0.0, -1.0};
    r.direction = {std::cos(angle), std::sin(angle)};
    return r;
  };
  EXPECT_TRUE(meet(ray(0.5 * kPi), line).meets);
  EXPECT_NEAR(meet(ray(0.5 * kPi), line).range, 1.0, 1e-12);
  EXPECT_FALSE(meet(ray(-0.5 * kPi), line).meets) << "it lies behind";
  EXPECT_TRUE(meet(ray(0.05), line).meets);
  EXPECT_FALSE(meet(ray(0.01), line).meets) << "100 m off: nothing is said of such a place";
}

}  // namespace
}  // namespace phasescan::occupancy_rules_test
