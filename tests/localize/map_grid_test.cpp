// Cells, distances, rays, surfaces and views of a map.
#include "localize/map_grid.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"
#include "localize/map_surface.hpp"
#include "localize/view_kernel.hpp"
#include "localize/view_table.hpp"
#include "support/toy_map.hpp"

namespace phasescan::map_grid_test {
namespace {

using testing::toy_map;
using testing::two_rooms;

TEST(MapGrid, DistancesAreThoseOfASlowSearch) {
  const MapGrid grid = make_map_grid(toy_map(two_rooms(), {0, 0}, 0.1));
  for (int k = 0; k < grid.height; k += 3) {
    for (int i = 0; i < grid.width; i += 3) {
      float nearest = 1e9F;
      for (int b = 0; b < grid.height; ++b) {
        for (int a = 0; a < grid.width; ++a) {
          if (grid.is_occupied(a, b))
            nearest = std::min(nearest, std::hypot(static_cast<float>(a - i), static_cast<float>(b - k)));
        }
      }
      const float expected = std::min(255.0F, std::round(8.0F * nearest));
      ASSERT_EQ(static_cast<float>(grid.distance[grid.index(i, k)]), expected) << i << " " << k;
    }
  }
}

TEST(MapGrid, FineCellsAreMergedAndWallsStay) {
  const TrinaryMap fine = toy_map(two_rooms(), {0, 0}, 0.01);
  const MapGrid grid = make_map_grid(fine);
  EXPECT_NEAR(grid.cell_m, 0.05, 1e-6);
  EXPECT_EQ(grid.width, (fine.width + 4) / 5);
  std::size_t occupied = 0;
  for (int k = 0; k < fine.height; ++k) {
    for (int i = 0; i < fine.width; ++i) {
      if (fine.at(i, k) != CellState::kOccupied) continue;
      ++occupied;
      ASSERT_TRUE(grid.is_occupied(i / 5, k / 5));
    }
  }
  EXPECT_GT(occupied, 1000U);
}

TEST(MapGrid, RaysMeetWallsWhereTheyAre) {
  const TrinaryMap map = toy_map(two_rooms(), {0, 0});
  const MapGrid grid = make_map_grid(map);
  const Pose2 T_grid_map = map.origin.inverse();
  Random random(3);
  for (int n = 0; n < 300; ++n) {
    const Eigen::Vector2d from(random.uniform(-1.5, 2.5), random.uniform(-1.5, 1.0));
    const double angle = random.uniform(-kPi, kPi), expected = testing::toy_range(two_rooms(), from, angle);
    const Eigen::Vector2d at = T_grid_map * from;
    const double range =
        static_cast<double>(grid.cast(static_cast<float>(at.x()), static_cast<float>(at.y()),
                                      static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 30.0F));
    // Of rays that graze a wall or pass an edge closely the cells say less.
    if (std::abs(range - expected) > 0.1) {
      bool sharp = false;
      for (const double off : {-0.06, 0.06})
        sharp |= std::abs(testing::toy_range(two_rooms(), from, angle + off) - expected) > 0.2;
      EXPECT_TRUE(sharp) << from.transpose() << " " << angle << ": " << range << " for " << expected;
    }
  }
}

TEST(MapSurface, NormalsFaceTheRoomAndThinWallsHaveTwoSides) {
  const TrinaryMap map =
      toy_map({{{0, 0}, {4, 0}}, {{4, 0}, {4, 3}}, {{4, 3}, {0, 3}}, {{0, 3}, {0, 0}}, {{2, 1}, {2, 2}}}, {1, 1});
  const MapPoints surface = map_surface(make_map_grid(map));
  int left = 0, right = 0, wrong = 0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface.lone(i)) continue;
    const Eigen::Vector2d p =
        map.origin * Eigen::Vector2d(static_cast<double>(surface.x[i]), static_cast<double>(surface.y[i]));
    const double nx = static_cast<double>(surface.nx[i]), ny = static_cast<double>(surface.ny[i]);
    if (p.x() < 0.1 && p.y() > 0.5 && p.y() < 2.5) wrong += !(nx > 0.95);
    if (p.y() > 2.9 && p.x() > 0.5 && p.x() < 3.5) wrong += !(ny < -0.95);
    if (std::abs(p.x() - 2.0) < 0.1 && p.y() > 1.3 && p.y() < 1.7) (nx > 0 ? right : left) += std::abs(nx) > 0.95;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(left, 6);
  EXPECT_GE(right, 6);
}

std::vector<std::uint8_t> random_bytes(std::size_t count, Random& random) {
  std::vector<std::uint8_t> bytes(count);
  for (auto& v : bytes) v = static_cast<std::uint8_t>(random.below(256));
  return bytes;
}
std::vector<std::uint8_t> random_caps(std::size_t count, Random& random) {
  std::vector<std::uint8_t> caps(count);
  for (auto& v : caps) v = random.chance(0.8) ? kMostDifference : std::uint8_t{0};
  return caps;
}

TEST(ViewKernel, IsThePlainSumOfCappedDifferences) {
  Random random(5);
  const auto view = random_bytes(kViewDirections, random);
  const std::size_t rows = kCoarseDirections * kCoarseTurns;
  const auto rotated = random_bytes(rows, random), most = random_caps(rows, random);
  std::uint16_t cost[kCoarseTurns];
  const std::uint16_t least = compare_at_coarse_turns(view.data(), 200, rotated.data(), most.data(), cost);
  const auto off = [&](std::size_t d, std::uint8_t other) { return std::abs(std::min<int>(view[d], 200) - other); };
  for (std::size_t t = 0; t < kCoarseTurns; ++t) {
    int sum = 0;
    for (std::size_t c = 0; c < kCoarseDirections; ++c)
      sum += std::min<int>(off(c, rotated[c * kCoarseTurns + t]), most[c * kCoarseTurns + t]);
    EXPECT_EQ(cost[t], sum);
  }
  EXPECT_EQ(least, *std::min_element(cost, cost + kCoarseTurns));
  int sum = 0;
  for (std::size_t d = 0; d < kViewDirections; ++d) sum += std::min<int>(off(d, rotated[d]), most[d]);
  EXPECT_EQ(compare_at_turn(view.data(), 200, rotated.data(), most.data()), sum);
}

TEST(ViewTable, EveryDirectionHasAPlaceOfItsOwnAndCoarseOnesTheFirst) {
  std::vector<int> taken(kViewDirections, 0);
  for (std::size_t d = 0; d < kViewDirections; ++d) {
    ++taken[view_place(d)];
    EXPECT_EQ(view_place(d) < kCoarseDirections, d % (kViewDirections / kCoarseDirections) == 0);
  }
  EXPECT_EQ(std::count(taken.begin(), taken.end(), 1), static_cast<long>(kViewDirections));
}

TEST(ViewTable, TheViewNearAPoseIsAmongTheBest) {
  const TrinaryMap map = toy_map(two_rooms(), {0, 0});
  const MapGrid grid = make_map_grid(map);
  const ViewTable views = make_views(grid, 0.35, 30.0);
  EXPECT_GT(views.size(), 300U);
  Random random(9);
  ViewSearch search;
  for (int n = 0; n < 20; ++n) {
    const Pose2 T_map_laser{random.uniform(-1.5, 2.5), random.uniform(-1.5, 1.0), random.uniform(-kPi, kPi)};
    match_views(views, view_of(testing::toy_scan(two_rooms(), T_map_laser, {}, random, 0)), 40, search);
    const Pose2 T_grid_laser = map.origin.inverse() * T_map_laser;
    bool found = false;
    for (const ViewMatch& match : search.best) {
      const double off = std::hypot(static_cast<double>(views.x[match.view]) - T_grid_laser.x,
                                    static_cast<double>(views.y[match.view]) - T_grid_laser.y);
      found |= off < 0.4 && angle_distance(kTwoPi * match.turn / 128.0, T_grid_laser.theta) < 0.1;
    }
    EXPECT_TRUE(found) << n;
    EXPECT_LE(search.best.size(), 40U);
    EXPECT_TRUE(std::is_sorted(search.best.begin(), search.best.end(),
                               [](const ViewMatch& a, const ViewMatch& b) { return a.cost < b.cost; }));
  }
}

TEST(ScanView, EmptyDirectionsAreKnownOnlyWhereASensorLooked) {
  std::vector<float> ranges(360, 2.0F);
  for (std::size_t i = 100; i < 160; ++i) ranges[i] = 0.0F;  // nothing came back from a wide sector
  ranges[200] = 0.0F;                                        // one beam lost
  const ScanView view = view_of(make_scan(ranges, {0.0, kTwoPi / 360, 0.1, 6.0}));
  EXPECT_EQ(view.known_count, kViewDirections);
  EXPECT_EQ(view.range[46], view.reach);  // 130 deg
  EXPECT_EQ(view.range[71], view_byte(2.0F));
  const ScanView half = view_of(make_scan(std::vector<float>(180, 2.0F), {-kPi / 2, kPi / 180, 0.1, 6.0}));
  EXPECT_NEAR(static_cast<double>(half.known_count), 64.0, 2.0);
}

}  // namespace
}  // namespace phasescan::map_grid_test
