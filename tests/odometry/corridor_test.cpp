// Corridors: what little shows the way along them, and what only seems to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "phasescan/odometry/odometry.hpp"
#include "phasescan/sim/drive.hpp"
#include "phasescan/sim/pairs_spec.hpp"
#include "phasescan/sim/world_file.hpp"
#include "support/toy_world.hpp"

namespace phasescan {
namespace {

using testing::toy_scan;
using testing::ToyLidar;
using testing::Wall;

constexpr double kPeriod = 0.2;

/// Bare walls on both sides from an end at x = 0 on.
std::vector<Wall> corridor() {
  return {{{0, -0.8}, {0, 0.8}}, {{0, -0.8}, {40, -0.8}}, {{0, 0.8}, {40, 0.8}}};
}

/// The largest error of a step between two scans of a drive through a flat where three people walk about.
double worst_step(std::uint64_t seed, int from, int to) {
  const sim::World world = sim::world_by_name("flat:1", seed);
  const sim::LidarOptions lidar = sim::read_lidar("rplidar-a1");
  sim::PathOptions path;
  path.speed_mps = 0.5;
  path.turn_rate_dps = 90.0;
  path.duration_s = 2500.0 / lidar.rate_hz;
  sim::DriveOptions people;
  people.people = 3;
  sim::Drive drive(world, lidar, sim::Path(world, path, Random::derive(seed, 1)), people, Random::derive(seed, 2));
  Odometry odometry;
  Pose2 found, truth;
  double worst = 0.0;
  for (int i = 0; i < to; ++i) {
    const auto scan = drive.next();
    if (!scan || i < from) continue;
    const Pose2 now = odometry.add(scan->entry.scan, {}, std::nullopt).T_odom_stamp;
    if (i > from + 2)
      worst = std::max(worst, translation_distance(found.inverse() * now, truth.inverse() * scan->T_world_laser));
    found = now, truth = scan->T_world_laser;
  }
  return worst;
}

TEST(Corridor, SomebodyWhoWalksAheadDoesNotPullTheRobotAlong) {
  // A corridor of a flat; the one who walks there hides its end and is nearly all that shows the way along it.
  EXPECT_LT(worst_step(2, 2100, 2190), 0.06);
  EXPECT_LT(worst_step(4, 1880, 1960), 0.06);
}

/// How far a robot is off that drove away from a corridor's end, the last 3 of 6 m with nothing in sight but bare
/// walls, and what it says of that itself.
struct Unseen {
  double off_m = 0.0, sigma_m = 0.0;
};

Unseen drive_unseen(std::uint64_t seed) {
  const auto walls = corridor();
  const ToyLidar lidar{.beams = 180, .range_max = 6.0, .field = kPi};
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
  EXPECT_LT(off[4], 0.8);  // of 3 m; taken for seen, the noise of the walls' normals held the robot where it was
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
