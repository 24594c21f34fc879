// Corridors: what little shows the way along them, and what only seems to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "phasescan/odometry/odometry.hpp"
#include "support/toy_world.hpp"

namespace phasescan {
namespace {

using testing::toy_scan;
using testing::ToyLidar;
using testing::Wall;

constexpr double kPeriod = 0.2;

/// Walls on both sides from x = 0 to `length`, with niches for doors `every` metres apart and an end at x = 0.
std::vector<Wall> corridor(double length, double every) {
  std::vector<Wall> walls = {{{0, -0.8}, {0, 0.8}}};
  for (const double side : {-1.0, 1.0}) {
    double x = 0.0;
    for (double door = every; every > 0.0 && door + 0.9 < length; door += every) {
      const double at = side > 0 ? door : door + 0.4 * every;
      walls.push_back({{x, 0.8 * side}, {at, 0.8 * side}});
      walls.push_back({{at, 0.8 * side}, {at, 1.1 * side}});
      walls.push_back({{at, 1.1 * side}, {at + 0.9, 1.1 * side}});
      walls.push_back({{at + 0.9, 1.1 * side}, {at + 0.9, 0.8 * side}});
      x = at + 0.9;
    }
    walls.push_back({{x, 0.8 * side}, {length, 0.8 * side}});
  }
  return walls;
}

void add_person(std::vector<Wall>& walls, double x, double y) {
  Eigen::Vector2d last(x + 0.22, y);
  for (int i = 1; i <= 10; ++i) {
    const double a = kTwoPi * i / 10;
    const Eigen::Vector2d next(x + 0.22 * std::cos(a), y + 0.16 * std::sin(a));
    walls.push_back({last, next});
    last = next;
  }
}

TEST(Corridor, SomebodyWhoWalksAheadDoesNotPullTheRobotAlong) {
  const auto walls = corridor(30.0, 2.5);
  ToyLidar lidar;
  lidar.range_max = 6.0;
  for (const double speed : {0.8, 1.0}) {  // of the person [m/s]; the robot's is 0.5
    Random random(7);
    Odometry odometry;
    double worst = 0.0;
    for (int i = 0; i < 120; ++i) {
      const double t = kPeriod * i, x = 2.0 + 0.5 * t;
      auto now = walls;
      // Comes by from behind, walks ahead and out of sight.
      const double person = x - 3.0 + (speed - 0.5) * std::max(0.0, t - 5.0);
      if (std::abs(person - x) > 0.5) add_person(now, person, 0.1);
      const OdometryStep step =
          odometry.add(toy_scan(now, {x, 0, 0}, lidar, random, stamp_from_seconds(t)), {}, std::nullopt);
      worst = std::max(worst, std::abs(step.T_odom_mid.x - 0.5 * t));
    }
    EXPECT_LT(worst, 0.1) << speed;
  }
}

/// How far a robot is off that drove away from a corridor's end, the last 3 of 6 m with nothing in sight but bare
/// walls, and what it says of that itself.
struct Unseen {
  double off_m = 0.0, sigma_m = 0.0;
};

Unseen drive_unseen(std::uint64_t seed) {
  const auto walls = corridor(40.0, 0.0);
  ToyLidar lidar;
  lidar.range_max = 6.0;
  lidar.beams = 180;
  lidar.field = kPi;
  Random random(seed);
  Odometry odometry;
  Unseen out;
  for (int i = 0; i < 100; ++i) {
    const OdometryStep step = odometry.add(
        toy_scan(walls, {3.0 + 0.06 * i, 0, kPi}, lidar, random, stamp_from_seconds(kPeriod * i)), {}, std::nullopt);
    out.off_m = std::abs(step.T_odom_mid.x + 0.06 * i);
    // Of the way since the last keyframe.
    out.sigma_m = std::max(out.sigma_m, 1.0 / std::sqrt(std::max(1e-9, step.information(0, 0))));
  }
  return out;
}

TEST(Corridor, TheMotionGoesOnWhereNothingShowsItAndIsNotTakenForSeen) {
  std::vector<double> off;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    const Unseen run = drive_unseen(seed);
    EXPECT_GT(run.sigma_m, 0.12) << seed;
    off.push_back(run.off_m);
  }
  std::sort(off.begin(), off.end());
  EXPECT_LT(off[4], 0.4);
  EXPECT_LT(off.back(), 2.0);
}

std::vector<float> rough_corridor(double x, Random& noise) {
  // The relief is a function of the place, not of the beam.
  std::vector<float> ranges;
  for (int k = 0; k < 180; ++k) {
    const double angle = -0.5 * kPi + k * kPi / 180;
    const double across = std::abs(std::sin(angle));
    double range = across > 1e-6 ? 0.9 / across : 100.0;
    const double place = x + range * std::cos(angle);
    const double relief = 0.012 * std::sin(97.0 * place) * std::sin(41.0 * place + (angle > 0 ? 1.0 : 0.0));
    if (range < 6.0) range += relief / across;
    ranges.push_back(range < 6.0 ? static_cast<float>(range + noise.normal(0.0, 0.002)) : 0.0F);
  }
  return ranges;
}

SurfacePoints surface_of(const std::vector<float>& ranges) {
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(make_scan(ranges, {-0.5 * kPi, kPi / 180, 0.0, 6.0}), {}, work, surface);
  return surface;
}

TEST(MotionHabits, TheReliefOfBareWallsTellsRestFromMotion) {
  Random noise(1);
  ReliefWitness witness;
  EXPECT_FALSE(witness.add(surface_of(rough_corridor(0.0, noise))).has_value());
  EXPECT_GT(witness.add(surface_of(rough_corridor(0.0, noise))).value(), 0.7);
  EXPECT_LT(witness.add(surface_of(rough_corridor(0.06, noise))).value(), 0.4);
  EXPECT_GT(witness.add(surface_of(rough_corridor(0.06, noise))).value(), 0.7);
  EXPECT_FALSE(witness.add(SurfacePoints{}).has_value());
}

TEST(MotionHabits, AssumesRestOrTheUsualMotionOnceBothAreKnown) {
  Random noise(2);
  MotionHabits habits;
  double x = 0.0;
  const auto go = [&](double step, bool seen) {
    x += step;
    habits.add(surface_of(rough_corridor(x, noise)));
    const auto assumed = habits.assume(0.0);
    habits.learn({step, 0.0, 0.0}, seen);
    return assumed;
  };
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(go(0.0, true).has_value()) << i;  // nothing is usual yet
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(go(0.06, true).has_value()) << i;
  // Rest and the end of it, unseen.
  go(0.0, false), go(0.0, false);
  const auto rest = go(0.0, false);
  ASSERT_TRUE(rest.has_value());
  EXPECT_EQ(rest->x, 0.0);
  const auto start = go(0.06, false);
  ASSERT_TRUE(start.has_value());
  EXPECT_NEAR(start->x, 0.06, 0.005);
  EXPECT_FALSE(go(0.06, false).has_value());  // and so it goes on
}

}  // namespace
}  // namespace phasescan
