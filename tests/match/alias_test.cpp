// Two rules of the search that only places with little to tell show: the alias of a symmetric room, however far off it
// lies, and the better place a little along a corridor.
#include <gtest/gtest.h>

#include <algorithm>

#include "phasescan/match/scan_matcher.hpp"
#include "support/toy_world.hpp"

namespace phasescan::alias_test {
namespace {

/// A room of 5 x 3.4 m that looks the same after half a turn about its middle.
std::vector<testing::Wall> rectangle() {
  return {
      {{-2.5, -1.7}, {2.5, -1.7}}, {{2.5, -1.7}, {2.5, 1.7}}, {{2.5, 1.7}, {-2.5, 1.7}}, {{-2.5, 1.7}, {-2.5, -1.7}}};
}

TEST(GlobalMatch, TheAliasOfASymmetricRoomIsFoundBeyondTheWindowOfTheSweep) {
  // The window of a rotation reaches half the scale, 1.6 m here, to every side. The sensor stands more than 1 m from
  // the middle, so its alias is more than 2 m away.
  const auto walls = rectangle();
  Random random(5);
  testing::ToyLidar lidar;
  lidar.noise = 0.01;
  ScanMatcher matcher;
  for (int k = 0; k < 20; ++k) {
    const Pose2 T_room_ref{random.uniform(1.0, 1.3), random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2)};
    const Pose2 truth{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.6, 0.6)};
    const Pose2 alias = T_room_ref.inverse() * Pose2{0.0, 0.0, kPi} * T_room_ref * truth;
    const Scan reference = testing::toy_scan(walls, T_room_ref, lidar, random, {});
    const MatchResult found = matcher.match(reference, testing::toy_scan(walls, T_room_ref * truth, lidar, random, {}));
    EXPECT_LT(translation_distance(found.T_ref_scan, truth), 0.05) << k;
    EXPECT_TRUE(found.ambiguous) << k;
    EXPECT_FALSE(found.usable) << k;
    EXPECT_TRUE(std::any_of(found.alternatives.begin(), found.alternatives.end(), [&](const MatchAlternative& other) {
      return translation_distance(other.T_ref_scan, alias) < 0.1;
    })) << k;
  }
}

TEST(GlobalMatch, ABetterPlaceALittleAlongACorridorIsTaken) {
  // Niches 5 cm deep tell where along the corridor the sensor is, and hardly draw a refinement that begins beside the
  // right place: 39 of 40 are within 0.1 m, 33 where the best of the poses tried along the corridor is not taken.
  const auto walls = testing::corridor_with_niches(30.0, 0.05);
  Random random(7);
  testing::ToyLidar lidar;
  lidar.beams = 720;
  lidar.noise = 0.01;
  lidar.range_max = 6.0;
  ScanMatcher matcher;
  int right = 0;
  for (int k = 0; k < 40; ++k) {
    const Pose2 T_world_ref{random.uniform(10.0, 20.0), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    const Pose2 truth{random.uniform(-0.5, 0.5), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    const Scan reference = testing::toy_scan(walls, T_world_ref, lidar, random, {});
    const Scan scan = testing::toy_scan(walls, T_world_ref * truth, lidar, random, {});
    right += translation_distance(matcher.match(reference, scan).T_ref_scan, truth) < 0.1;
  }
  EXPECT_GE(right, 37);
}

}  // namespace
}  // namespace phasescan::alias_test
