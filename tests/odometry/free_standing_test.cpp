// Small things that stand free: which hits are on one, and which of them stay where they are.
#include "odometry/free_standing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "odometry/tracker.hpp"
#include "support/toy_world.hpp"

namespace phasescan::free_standing_test {
namespace {

using testing::toy_scan;
using testing::ToyLidar;
using testing::Wall;

void add_square(std::vector<Wall>& walls, double x, double y, double half) {
  testing::add_box(walls, x - half, y - half, x + half, y + half);
}

std::vector<Wall> room() {
  std::vector<Wall> walls;
  add_square(walls, 0.0, 0.0, 3.0);
  return walls;
}

struct Marked {
  std::size_t on_thing = 0, elsewhere = 0, thing = 0;
};

/// How many hits within 0.3 m of (x, y) and elsewhere are marked, seen from the origin.
Marked mark(const std::vector<Wall>& walls, double x, double y, double field = kTwoPi) {
  ToyLidar lidar;
  lidar.field = field;
  Random random(1);
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(toy_scan(walls, {}, lidar, random, 0), {}, work, surface);
  std::vector<std::uint8_t> small;
  mark_free_standing(surface, small);
  Marked out;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const bool near = std::hypot(static_cast<double>(surface[i].x) - x, static_cast<double>(surface[i].y) - y) < 0.3;
    out.thing += near;
    if (small[i]) ++(near ? out.on_thing : out.elsewhere);
  }
  return out;
}

TEST(FreeStanding, WhatStandsFreeIsMarkedInEveryDirectionAndNothingElse) {
  for (double angle = 0.0; angle < 6.2; angle += 0.1) {
    const double x = 1.5 * std::cos(angle), y = 1.5 * std::sin(angle);
    std::vector<Wall> walls = room();
    add_square(walls, x, y, 0.15);
    const Marked m = mark(walls, x, y);
    EXPECT_GT(m.thing, 4U) << angle;
    EXPECT_EQ(m.on_thing, m.thing) << angle;
    EXPECT_EQ(m.elsewhere, 0U) << angle;
  }
}

TEST(FreeStanding, WallsAndWideThingsAreNotMarked) {
  EXPECT_EQ(mark(room(), 9.0, 9.0).elsewhere, 0U);
  std::vector<Wall> cupboard = room();
  add_square(cupboard, 1.8, 0.0, 0.5);
  EXPECT_EQ(mark(cupboard, 9.0, 9.0).elsewhere, 0U);
}

TEST(FreeStanding, AtTheEndOfTheViewToo) {
  // Half of it is beyond the last beam.
  std::vector<Wall> walls = room();
  add_square(walls, 0.0, 1.5, 0.15);
  const Marked m = mark(walls, 0.0, 1.5, kPi);
  EXPECT_GT(m.thing, 2U);
  EXPECT_EQ(m.on_thing, m.thing);
}

TEST(FreeStanding, WhereThereIsLittleElseNoneIsMarked) {
  // Trunks of trees, with nothing behind.
  std::vector<Wall> trunks;
  for (int k = 0; k < 12; ++k) add_square(trunks, 2.0 * std::cos(0.52 * k), 2.0 * std::sin(0.52 * k), 0.15);
  const Marked m = mark(trunks, 9.0, 9.0);
  EXPECT_EQ(m.elsewhere, 0U);
}

TEST(StaticObjectFilter, OneSeenAgainAfterTheRobotMovedStaysAndOneThatMovesWithItDoesNot) {
  std::vector<FreeStandingHit> hits;
  std::vector<Pose2> poses;
  for (int k = 0; k < 5; ++k) {
    const float x = 0.5F * static_cast<float>(k);
    poses.push_back({static_cast<double>(x), 0.0, 0.0});
    hits.push_back({3.0F, 1.0F, 3.0F - x, 1.0F, k});  // a pillar
    hits.push_back({x + 1.2F, 0.0F, 1.2F, 0.0F, k});  // somebody ahead
  }
  std::vector<std::uint8_t> stays;
  StaticObjectFilter().find(hits, poses, stays);
  ASSERT_EQ(stays.size(), hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_EQ(stays[i], i % 2 == 0) << i;
  // Seen once, or again before the robot moved, a pillar is not known to stay.
  hits = {{3.0F, 1.0F, 3.0F, 1.0F, 0}, {3.0F, 1.0F, 2.8F, 1.0F, 1}};
  poses = {{0, 0, 0}, {0.2, 0, 0}};
  StaticObjectFilter().find(hits, poses, stays);
  EXPECT_EQ(stays, (std::vector<std::uint8_t>{0, 0}));
  StaticObjectFilter().find({}, {}, stays);
  EXPECT_TRUE(stays.empty());
}

/// How far off a robot ends that follows somebody for 12 m through a corridor with a few niches.
double led_by_somebody(std::uint64_t seed, bool wheels) {
  const std::vector<Wall> corridor = testing::corridor_with_niches(20.0, 0.4);
  const ToyLidar lidar{.beams = 180, .range_max = 6.0, .field = kPi};
  Random random(seed);
  Tracker tracker;
  TrackerStep step;
  double x = 1.5;
  const int scans = 240;
  for (int i = 0; i < scans; ++i) {
    std::vector<Wall> now = corridor;
    const double sway = 0.15 * std::sin(0.05 * i);
    add_square(now, x + 1.1 + sway, 0.3 * std::sin(0.03 * i), 0.2);
    const std::optional<Pose2> wheel = wheels ? std::optional<Pose2>({1.02 * (x - 1.5), 0, 0}) : std::nullopt;
    step = tracker.add({toy_scan(now, {x, 0, 0}, lidar, random, stamp_from_seconds(0.1 * i)), "", {}, wheel});
    if (i + 1 < scans) x += std::min(0.05, 0.005 * i);
  }
  return std::abs(step.T_odom_mid.x - (x - 1.5));
}

TEST(FreeStanding, SomebodyWhoLeadsTheRobotDoesNotHoldIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(led_by_somebody(seed, true), 0.3) << seed;
    EXPECT_LT(led_by_somebody(seed, false), 0.6) << seed;
  }
}

}  // namespace
}  // namespace phasescan::free_standing_test
