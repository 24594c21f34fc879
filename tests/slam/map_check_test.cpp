// The map against its own scans: one room driven through in circles, and what happens to a later visit that stands
// elsewhere.
#include "slam/map_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/rooms.hpp"

namespace phasescan::map_check_test {
namespace {

struct Drive {
  std::vector<Pose2> poses;
  std::vector<double> way_m;
};

/// Rounds of a metre across, a scan every 0.4 m.
Drive rounds(std::size_t scans) {
  Drive drive;
  for (std::size_t k = 0; k < scans; ++k) {
    const double turn = 0.4 * static_cast<double>(k);
    drive.poses.push_back({1.0 * std::cos(turn), 0.2 + 0.8 * std::sin(turn), turn + kPi / 2.0});
    drive.way_m.push_back(0.4 * static_cast<double>(k));
  }
  return drive;
}

/// @param T_map_later  what takes the second half of the scans to where the map has it
MapCheck check(const Drive& drive, const Pose2& T_map_later) {
  const auto scan_of = [&](std::size_t k) {
    PlacedScan placed;
    placed.scan = test::cast_room(drive.poses[k], 180, 0.01, 0.05, k + 1, 8.0);
    placed.T_map_laser = 2 * k < drive.poses.size() ? drive.poses[k] : T_map_later * drive.poses[k];
    return placed;
  };
  return check_map(drive.poses.size(), scan_of, drive.way_m);
}

TEST(MapCheck, AMapThatIsRightFitsItsScans) {
  const MapCheck found = check(rounds(80), {});
  EXPECT_GT(found.far.scans, 60u);
  EXPECT_LT(found.far.worst.against(), 0.1);
  EXPECT_LT(found.near.worst.against(), 0.1);
  EXPECT_EQ(found.far.contradicting, 0u);
  EXPECT_EQ(found.far.doubling, 0u);
}

TEST(MapCheck, AVisitThatStandsAsideDoublesTheWalls) {
  const MapCheck found = check(rounds(80), {0.25, 0.3, 0.0});
  EXPECT_GT(found.far.worst.doubled, 0.25);
  EXPECT_GT(found.far.doubling, 5u);
  EXPECT_LT(found.near.mean.doubled, 0.1) << "neighbours on the way stand right to each other";
}

TEST(MapCheck, AFewScansThatStandAsideAreTheWorstPlaceAndNotTheTailOfALongRun) {
  const Drive drive = rounds(900);
  const auto scan_of = [&](std::size_t k) {
    PlacedScan placed;
    placed.scan = test::cast_room(drive.poses[k], 90, 0.01, 0.05, k + 1, 8.0);
    placed.T_map_laser = k >= 450 && k < 456 ? Pose2{1.5, -1.0, 0.8} * drive.poses[k] : drive.poses[k];
    return placed;
  };
  const MapCheck found = check_map(drive.poses.size(), scan_of, drive.way_m);
  EXPECT_GT(found.far.worst.against(), 0.4);
  EXPECT_LT(found.far.tail.against(), 0.5 * found.far.worst.against());
  // Where it is much of the run, the two are alike.
  const MapCheck half = check(rounds(80), {1.5, -1.0, 0.8});
  EXPECT_GT(half.far.tail.against(), 0.8 * half.far.worst.against());
  EXPECT_LE(half.far.tail.against(), half.far.worst.against() + 1e-12);
}

TEST(MapCheck, AVisitThatStandsFarOffGoesThroughWalls) {
  const MapCheck found = check(rounds(80), {1.5, -1.0, 0.8});
  EXPECT_GT(found.far.worst.crossed + found.far.worst.in_free, 0.4);
  EXPECT_GT(found.far.contradicting, 10u);
}

TEST(MapCheck, WhatWasSeenOnceSaysNothing) {
  Drive drive = rounds(12);
  const MapCheck found = check(drive, {1.5, -1.0, 0.8});
  EXPECT_EQ(found.far.scans, 0u) << "no visit is 8 m away from another on the way";
  EXPECT_EQ(check_map(0, [](std::size_t) { return PlacedScan{}; }, {}).near.scans, 0u);
}

}  // namespace
}  // namespace phasescan::map_check_test
