#include "map/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "core/random.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::occupancy_grid_test {
namespace {

Scan scan_of(const std::vector<float>& ranges, double angle_min, double increment, double range_max = 0.0) {
  ScanGeometry g;
  g.angle_min = angle_min;
  g.angle_increment = increment;
  g.range_max = range_max;
  return make_scan(ranges, g);
}

TEST(OccupancyGrid, OneRayMarksFreeCellsAndItsHit) {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  OccupancyGrid grid(options);
  grid.add_scan(scan_of({1.0F}, 0.0, 0.1), {0.05, 0.05, 0.0});
  EXPECT_NEAR(grid.log_odds(10, 0), 0.9, 1e-9);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(grid.log_odds(i, 0), -0.4, 1e-9) << i;
  EXPECT_FALSE(grid.known(11, 0));
  EXPECT_FALSE(grid.known(5, 1));
  for (int k = 0; k < 100; ++k) grid.add_scan(scan_of({1.0F}, 0.0, 0.1), {0.05, 0.05, 0.0});
  EXPECT_NEAR(grid.log_odds(10, 0), 5.0, 1e-9);
  EXPECT_NEAR(grid.log_odds(3, 0), -5.0, 1e-9);
}

TEST(OccupancyGrid, WhatALaterDriveIsSureOfTakesThePlaceOfWhatWasKnown) {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  const Scan near = scan_of({1.0F}, 0.0, 0.1), far = scan_of({2.0F}, 0.0, 0.1);
  OccupancyGrid before(options);
  for (int k = 0; k < 100; ++k) before.add_scan(near, {0.05, 0.05, 0.0});
  ASSERT_NEAR(before.log_odds(10, 0), 5.0, 1e-9);
  for (const int looks : {1, 2, 3, 4, 10}) {
    // The thing is gone: rays go through where it was, to the wall behind it.
    OccupancyGrid now(options), map(options);
    for (int k = 0; k < looks; ++k) now.add_scan(far, {0.05, 0.05, 0.0});
    map.update_with(before);
    EXPECT_NEAR(map.log_odds(10, 0), before.log_odds(10, 0), 1e-9);
    map.update_with(now);
    const double seen = std::max(-0.4 * looks, -5.0), kept = std::max(0.0, 1.0 + seen / 1.4);
    EXPECT_NEAR(map.log_odds(10, 0), 5.0 * kept + seen, 0.05) << looks;
    EXPECT_NEAR(map.log_odds(20, 0), std::min(0.9 * looks, 5.0), 1e-9);
    EXPECT_FALSE(map.known(10, 1));  // where neither looked
  }
  // And what stands there now is there, wherever it was free.
  OccupancyGrid open(options), now(options);
  for (int k = 0; k < 100; ++k) open.add_scan(far, {0.05, 0.05, 0.0});
  for (int k = 0; k < 2; ++k) now.add_scan(near, {0.05, 0.05, 0.0});
  open.update_with(now);
  EXPECT_GT(open.log_odds(10, 0), 1.7);
  EXPECT_NEAR(open.log_odds(20, 0), 5.0, 1e-9);  // it was not looked at since
}

TEST(OccupancyGrid, FreeCellsAreThoseTheRayPassesThrough) {
  // Against brute force: sample each ray finely and collect the cells.
  Random random(12);
  for (int trial = 0; trial < 50; ++trial) {
    OccupancyOptions options;
    options.resolution_m = 0.1;
    OccupancyGrid grid(options);
    const Pose2 pose{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-kPi, kPi)};
    const double range = random.uniform(0.5, 4.0);
    grid.add_scan(scan_of({static_cast<float>(range)}, 0.0, 0.1), pose);
    std::set<std::pair<int, int>> touched;
    for (double t = 0.0; t < range; t += 0.0005) {
      touched.insert(
          {grid.cell_of(pose.x + t * std::cos(pose.theta)), grid.cell_of(pose.y + t * std::sin(pose.theta))});
    }
    int missed = 0;
    for (const auto& [i, k] : touched) missed += !grid.known(i, k);
    EXPECT_EQ(missed, 0);
    const auto b = grid.bounds();
    int extra = 0;
    for (int i = b.min_i; i <= b.max_i; ++i) {
      for (int k = b.min_k; k <= b.max_k; ++k) extra += grid.known(i, k) && !touched.count({i, k});
    }
    EXPECT_LE(extra, 2);  // corners cut by less than the sampling step, and the hit itself
  }
}

TEST(OccupancyGrid, RaycastAgreesWithBruteForce) {
  OccupancyOptions options;
  options.resolution_m = 0.05;
  OccupancyGrid grid(options);
  // A room of 4 x 3 m drawn by a scan from its middle.
  std::vector<float> ranges;
  for (int i = 0; i < 720; ++i) {
    const double a = i * kPi / 360.0, c = std::abs(std::cos(a)), s = std::abs(std::sin(a));
    ranges.push_back(static_cast<float>(std::min(c > 1e-9 ? 2.0 / c : 1e9, s > 1e-9 ? 1.5 / s : 1e9)));
  }
  for (int k = 0; k < 3; ++k) grid.add_scan(scan_of(ranges, 0.0, kPi / 360.0), {0.01, 0.01, 0.0});
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector2d from(random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0));
    const double direction = random.uniform(-kPi, kPi);
    const auto found = grid.raycast(from, direction, 10.0);
    double brute = -1.0;
    for (double t = 0.0; t < 10.0 && brute < 0; t += 0.001) {
      if (grid.log_odds(grid.cell_of(from.x() + t * std::cos(direction)),
                        grid.cell_of(from.y() + t * std::sin(direction))) >= 0.6)
        brute = t;
    }
    ASSERT_EQ(found.has_value(), brute >= 0.0);
    // A corner cut by less than the brute step may be seen by one alone.
    if (found) {
      EXPECT_NEAR(*found, brute, 0.0711);
    }
  }
  EXPECT_FALSE(grid.raycast({0, 0}, 0.0, 1.0));
}

TEST(OccupancyGrid, MissingBeamsClearOnlyBetweenNeighbours) {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  OccupancyGrid grid(options);
  const std::vector<float> with_gap = {2.0F, 0.0F, 3.0F}, alone = {0.0F};
  grid.add_scan(scan_of(with_gap, -0.3, 0.3), {0.05, 0.05, 0.0});
  EXPECT_NEAR(grid.log_odds(15, 0), -0.1, 1e-9);  // 80 % of the shorter neighbour: 1.6 m
  EXPECT_FALSE(grid.known(17, 0));
  OccupancyGrid empty(options);
  empty.add_scan(scan_of(alone, 0.0, 0.3), {});
  EXPECT_LT(empty.bounds().max_i, empty.bounds().min_i);
  EXPECT_THROW(OccupancyGrid(OccupancyOptions{0.0}), std::invalid_argument);
}

TEST(OccupancyGrid, AGridThatWasClearedIsDrawnOnLikeANewOne) {
  OccupancyGrid grid, fresh;
  grid.add_scan(scan_of({1.0F}, 0.0, 0.1), {});
  grid.clear();
  EXPECT_LT(grid.bounds().max_i, grid.bounds().min_i);
  grid.add_scan(scan_of({1.0F}, 0.0, 0.1), {});
  fresh.add_scan(scan_of({1.0F}, 0.0, 0.1), {});
  EXPECT_EQ(make_trinary(grid).cells, make_trinary(fresh).cells);
  EXPECT_TRUE(grid.known(10, 0));
}

TEST(OccupancyGrid, AGridThatWasMovedFromLeavesTheOtherAlone) {
  OccupancyGrid first;
  first.add_scan(scan_of({1.0F}, 0.0, 0.1), {});
  OccupancyGrid second(std::move(first));
  const double before = second.log_odds(5, 0);
  first.add_scan(scan_of({1.0F}, 0.0, 0.1), {});  // NOLINT(bugprone-use-after-move): empty, says the interface
  EXPECT_EQ(second.log_odds(5, 0), before);
  EXPECT_EQ(first.log_odds(5, 0), before);
  OccupancyGrid third;
  third = std::move(first);
  first.add_scan(scan_of({1.0F}, kPi / 2, 0.1), {});  // NOLINT(bugprone-use-after-move)
  EXPECT_FALSE(third.known(0, 5));
  EXPECT_FALSE(first.known(5, 0));
  EXPECT_TRUE(first.known(0, 5));
}

TEST(OccupancyGrid, ALaserUpsideDownIsDrawnFromItsMirroredScan) {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  OccupancyGrid grid(options);
  grid.add_scan(mirrored_scan(scan_of({1.0F}, kPi / 2, 0.1)), {0.05, 0.05, 0.0});
  EXPECT_GT(grid.log_odds(0, -10), 0.0);
  EXPECT_FALSE(grid.known(0, 9));
}

TEST(TrinaryMap, ThresholdsAndOrigin) {
  OccupancyOptions options;
  options.resolution_m = 0.1;
  OccupancyGrid grid(options);
  for (int k = 0; k < 6; ++k) grid.add_scan(scan_of({1.0F}, 0.0, 0.1), {-0.95, 0.05, 0.0});
  const TrinaryMap map = make_trinary(grid, 2);
  EXPECT_EQ(map.width, 11 + 4);
  EXPECT_EQ(map.height, 1 + 4);
  EXPECT_NEAR(map.origin.x, -1.2, 1e-9);
  EXPECT_NEAR(map.origin.y, -0.2, 1e-9);
  EXPECT_EQ(map.at(2 + 10, 2), CellState::kOccupied);
  EXPECT_EQ(map.at(2, 2), CellState::kFree);
  EXPECT_EQ(map.at(0, 0), CellState::kUnknown);
}

}  // namespace
}  // namespace phasescan::occupancy_grid_test
