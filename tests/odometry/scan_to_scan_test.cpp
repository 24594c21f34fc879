#include "odometry/scan_to_scan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>
#include <utility>

#include "support/toy_world.hpp"

namespace phasescan::scan_to_scan_test {
namespace {

using testing::toy_scan;
using testing::Wall;

TEST(ScanToScan, TheLeastKnownDirectionLiesAlongTheLongRoomWhateverTheHeadings) {
  // Walls along x are seen much more than those across it: what is least known is x, a little turned by the slanted
  // end.
  std::vector<Wall> walls;
  const auto add = [&](double x1, double y1, double x2, double y2) { walls.push_back({{x1, y1}, {x2, y2}}); };
  add(-5, -1, 6, -1), add(6, -1, 5.6, 1), add(5.6, 1, 1, 1), add(1, 1, 1, 1.3), add(1, 1.3, -5, 1.3),
      add(-5, 1.3, -5, -1);
  for (const bool upside_down : {false, true}) {
    for (const double heading : {0.0, 0.9, -2.0}) {
      for (const double turn : {0.0, 1.3}) {
        const Pose2 T_base_laser{0.1, -0.05, 0.6};
        const Pose2 T_odom_before{0.2, 0.1, heading}, T_odom_now{0.4, 0.05, wrap_angle(heading + turn)};
        Random random(3);
        ScanToScan matcher;
        LastScans last;
        const auto seen_from = [&](const Pose2& T_odom_base, Stamp stamp) {
          const Scan scan = toy_scan(walls, T_odom_base * T_base_laser, {}, random, stamp, {}, upside_down);
          return RangeMeasurement{upside_down ? mirrored_scan(scan) : scan, "", T_base_laser};
        };
        last.remember(seen_from(T_odom_before, 0), T_odom_before, {});
        const auto found = matcher.find(last, seen_from(T_odom_now, 1), {});
        ASSERT_TRUE(found) << heading << " " << turn << " " << upside_down;
        EXPECT_LT(translation_distance(found->T_odom_base, T_odom_now), 0.05)
            << heading << " " << turn << " " << upside_down;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(found->covariance.topLeftCorner<2, 2>());
        const Eigen::Vector2d least_known = eigen.eigenvectors().col(1);
        EXPECT_GT(std::abs(least_known.x()), 0.95) << heading << " " << turn << " " << upside_down << "\n"
                                                   << found->covariance;
      }
    }
  }
}

/// How many of so many matches in a row, the robot driving along, are taken for certain.
int certain_of(int count, const std::vector<Wall>& walls, double from_x, LastScans& last, Random& random) {
  const testing::ToyLidar lidar{.beams = 180, .range_max = 6.0, .noise = 0.02, .field = kPi};
  ScanToScan matcher;
  int certain = 0;
  for (int i = 0; i < count; ++i) {
    const Pose2 before{from_x + 0.05 * i, 0.0, 0.0}, now{from_x + 0.05 * (i + 1), 0.0, 0.0};
    last.remember({toy_scan(walls, before, lidar, random, 0)}, before, {});
    const auto found = matcher.find(last, {toy_scan(walls, now, lidar, random, 1)}, {});
    certain += found && found->certain;
  }
  return certain;
}

TEST(ScanToScan, EachLaserIsMatchedWithItsOwnLastScan) {
  // One looks ahead, the other back: they share hardly anything.
  const auto walls = testing::two_rooms();
  const testing::ToyLidar half{.beams = 240, .range_max = 8.0, .noise = 0.01, .field = kPi};
  const std::pair<std::string, Pose2> lasers[] = {{"front", {0.2, 0.0, 0.0}}, {"rear", {-0.2, 0.0, kPi}}};
  Random random(5);
  ScanToScan matcher;
  LastScans last;
  const Pose2 before{0.2, 0.1, 0.3}, now{0.3, 0.15, 0.4};
  for (const auto& [name, T_base_laser] : lasers)
    last.remember({toy_scan(walls, before * T_base_laser, half, random, 0), name, T_base_laser}, before, {});
  for (const auto& [name, T_base_laser] : lasers) {
    const auto found =
        matcher.find(last, {toy_scan(walls, now * T_base_laser, half, random, 1), name, T_base_laser}, {});
    ASSERT_TRUE(found && found->certain);
    EXPECT_LT(translation_distance(found->T_odom_base, now), 0.02);
    EXPECT_LT(angle_distance(found->T_odom_base.theta, now.theta), 0.01);
  }
  last.forget();
  EXPECT_FALSE(matcher.find(last, {toy_scan(walls, now, half, random, 1), "front"}, {}));
}

TEST(ScanToScan, EachScanCountsWithTheMountingItWasTakenWith) {
  // The laser pans between the two scans: by a little, and by a quarter turn.
  const auto walls = testing::two_rooms();
  const Pose2 before{0.2, 0.1, 0.3}, now{0.3, 0.15, 0.4};
  for (const double pan : {0.02, kPi / 2}) {
    const Pose2 T_base_first{0.2, 0.0, 0.0}, T_base_second{0.2, 0.1, pan};
    Random random(6);
    ScanToScan matcher;
    LastScans last;
    last.remember({toy_scan(walls, before * T_base_first, {}, random, 0), "panning", T_base_first}, before, {});
    EXPECT_TRUE(last.knows("panning"));
    EXPECT_FALSE(last.knows("other"));
    const auto found =
        matcher.find(last, {toy_scan(walls, now * T_base_second, {}, random, 1), "panning", T_base_second}, {});
    ASSERT_TRUE(found && found->usable);
    EXPECT_LT(translation_distance(found->T_odom_base, now), 0.02) << pan;
    EXPECT_LT(angle_distance(found->T_odom_base.theta, now.theta), 0.01) << pan;
  }
}

TEST(ScanToScan, WhereMostMatchesAreAmbiguousTheFewThatClaimToKnowAreNotCertain) {
  const std::vector<Wall> corridor = {{{-20, -0.9}, {40, -0.9}}, {{-20, 0.9}, {40, 0.9}}};
  Random random(4);
  ScanToScan matcher;
  LastScans last;
  EXPECT_EQ(certain_of(30, testing::two_rooms(), -1.5, last, random), 30);
  EXPECT_EQ(certain_of(60, corridor, 0.0, last, random), 0);
  // Back in the rooms it takes a while.
  EXPECT_EQ(certain_of(3, testing::two_rooms(), -1.5, last, random), 0);
  EXPECT_GT(certain_of(30, testing::two_rooms(), -1.5, last, random), 15);
}

}  // namespace
}  // namespace phasescan::scan_to_scan_test
