// When a scan becomes a keyframe, what the local map keeps, and what a gap or a loss leaves of what was known.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "odometry/tracker.hpp"
#include "support/toy_world.hpp"

namespace phasescan::tracker_rules_test {
namespace {

using testing::add_box;
using testing::toy_scan;
using testing::ToyLidar;
using testing::two_rooms;
using testing::Wall;

constexpr double kPeriod = 0.1;

RangeMeasurement at(const std::vector<Wall>& walls, const Pose2& pose, double seconds, Random& random,
                    const ToyLidar& lidar = {}) {
  return {toy_scan(walls, pose, lidar, random, stamp_from_seconds(seconds))};
}

TEST(TrackerRules, TheLocalMapKeepsTheNewestKeyframes) {
  OdometryOptions options;
  options.window_keyframes = 4;
  Tracker tracker(options);
  Random random(1);
  for (int k = 0; k < 60; ++k) {
    tracker.add(at(two_rooms(), {-1.0 + 0.08 * k, 0.0, 0.0}, kPeriod * k, random));
    EXPECT_LE(tracker.state().window.size(), 4U);
  }
  EXPECT_EQ(tracker.state().window.size(), 4U);
}

TEST(TrackerRules, AScanThatTheMapHoldsLittleOfBecomesAKeyframeEarly) {
  // A lidar that sees 2.5 m far, along two walls with things on them: 1 m on, half of what it sees is new.
  std::vector<Wall> walls = {{{-3, -1.2}, {20, -1.2}}, {{-3, 1.2}, {20, 1.2}}};
  Random chance(7);
  for (double x = -2.0; x < 19.0; x += 0.9) {
    const double side = chance.uniform(0.0, 1.0) < 0.5 ? -1.2 : 0.8;
    add_box(walls, x, side, x + chance.uniform(0.2, 0.5), side + 0.4);
  }
  ToyLidar lidar;
  lidar.range_max = 2.5;
  OdometryOptions seldom;
  seldom.keyframe_distance_m = 3.0;
  Tracker tracker(seldom);
  Random random(2);
  std::vector<double> keyframes;
  for (int k = 0; k < 120; ++k) {
    const double x = 0.08 * k;
    if (tracker.add(at(walls, {x, 0.0, 0.0}, kPeriod * k, random, lidar)).keyframe) keyframes.push_back(x);
  }
  ASSERT_GT(keyframes.size(), 2U);
  for (std::size_t k = 2; k < keyframes.size(); ++k) EXPECT_LT(keyframes[k] - keyframes[k - 1], 2.6) << k;
}

TEST(TrackerRules, AlongABareCorridorKeyframesStandCloser) {
  const std::vector<Wall> walls = {{{-100, -1}, {100, -1}}, {{-100, 1}, {100, 1}}};
  OdometryOptions seldom;
  seldom.keyframe_distance_m = 2.0;
  Tracker tracker(seldom);
  Random random(3);
  std::size_t keyframes = 0;
  for (int k = 0; k < 60; ++k) {
    RangeMeasurement m = at(walls, {0.06 * k, 0.0, 0.0}, kPeriod * k, random);
    keyframes += tracker.add(m).keyframe;
  }
  EXPECT_GT(keyframes, 3U) << "what was driven unseen is corrected between keyframes";
}

TEST(TrackerRules, AMatchOfTooLittleOfAScanDoesNotCount) {
  Tracker tracker;
  Random random(4);
  for (int k = 0; k < 10; ++k) tracker.add(at(two_rooms(), {0.0, 0.0, 0.0}, kPeriod * k, random));
  // Carried off into a place of which hardly anything fits: one wall of many.
  std::vector<Wall> elsewhere;
  Random chance(5);
  for (int k = 0; k < 40; ++k) {
    const double x = chance.uniform(-4.0, 4.0), y = chance.uniform(-4.0, 4.0);
    if (std::hypot(x, y) > 1.0) add_box(elsewhere, x, y, x + 0.3, y + 0.2);
  }
  std::size_t tracked = 0;
  for (int k = 10; k < 13; ++k) tracked += tracker.add(at(elsewhere, {}, kPeriod * k, random)).tracked();
  EXPECT_EQ(tracked, 0U);
}

}  // namespace
}  // namespace phasescan::tracker_rules_test
