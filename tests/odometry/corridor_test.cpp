// Corridors: what little shows the way along them, and what only seems to.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "odometry/information.hpp"
#include "odometry/tracker.hpp"
#include "odometry/resolve_degenerate.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"
#include "support/toy_world.hpp"

namespace phasescan::corridor_test {
namespace {

using testing::corridor_with_niches;
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
  Tracker tracker;
  Pose2 found, truth;
  double worst = 0.0;
  for (int i = 0; i < to; ++i) {
    const auto scan = drive.next();
    if (!scan || i < from) continue;
    const Pose2 now = tracker.add({scan->entry.scan}).T_odom_stamp;
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
  Tracker tracker;
  Unseen out;
  for (int i = 0; i < 100; ++i) {
    const TrackerStep step =
        tracker.add({toy_scan(walls, {3.0 + 0.06 * i, 0, kPi}, lidar, random, stamp_from_seconds(kPeriod * i))});
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

/// How far off a robot is after 12 m between niches alone, started from rest there.
double drive_past_niches(double depth, std::uint64_t seed, bool wheels) {
  const auto walls = corridor_with_niches(40.0, depth);
  const ToyLidar lidar{.beams = 180, .range_max = 4.0, .field = kPi};
  Random random(seed);
  Tracker tracker;
  double x = 0.0, found = 0.0;
  for (int i = 0; i < 250; ++i) {
    x += std::min(0.05, 0.005 * i);
    const std::optional<Pose2> wheel = wheels ? std::optional<Pose2>({x, 0, 0}) : std::nullopt;
    const Scan scan = toy_scan(walls, {6.0 + x, 0, 0}, lidar, random, stamp_from_seconds(0.1 * i));
    found = tracker.add({scan, "", {}, wheel}).T_odom_mid.x;
  }
  return std::abs(found - x);
}

/// How far off a robot is at most that speeds up from 0.5 to 2 m/s in a wide hall with a few boxes along its walls, of
/// which a scanner with little sight shows a few hits each.
double speed_up_in_a_hall(std::uint64_t seed) {
  Random boxes(seed + 100), random(seed);
  std::vector<Wall> walls = {{{-5, -3.4}, {40, -3.4}}, {{-5, 3.4}, {40, 3.4}}};
  for (double x = -4.0; x < 40.0; x += 1.5) {
    for (const double side : {-3.4, 3.4}) {
      const double width = boxes.uniform(0.2, 0.6), depth = boxes.uniform(0.1, 0.5), at = x + boxes.uniform(0.0, 0.75);
      const double front = side > 0.0 ? side - depth : side + depth;
      testing::add_box(walls, at, std::min(side, front), at + width, std::max(side, front));
    }
  }
  const ToyLidar lidar{.beams = 240, .range_max = 4.0, .noise = 0.01, .field = 4.19};
  Tracker tracker;
  double x = 0.0, speed = 0.05, worst = 0.0;
  for (int i = 0; i < 120; ++i) {
    if (i > 30) speed = std::min(0.2, speed + 0.04);
    const TrackerStep step = tracker.add({toy_scan(walls, {x, 0.3, 0}, lidar, random, stamp_from_seconds(0.1 * i))});
    worst = std::max(worst, std::abs(step.T_odom_mid.x - x));
    x += speed;
  }
  return worst;
}

TEST(Corridor, ARobotThatSpeedsUpInASparseHallIsFollowed) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) sum += speed_up_in_a_hall(seed);
  EXPECT_LT(sum / 6.0, 0.55);  // of 20 m; without the match against the last scan 0.8
}

/// How far a robot is off at the end of a corridor whose log lost six scans every 30, written in bursts: three scans at
/// a time.
double drive_with_losses(std::uint64_t seed) {
  const auto walls = corridor_with_niches(30, 0.1);
  const ToyLidar lidar{.beams = 180, .range_max = 6.0, .field = kPi};
  Random random(seed);
  Tracker tracker;
  double off_m = 0.0;
  for (int i = 0; i < 240; ++i) {
    if (i > 60 && i % 30 < 6) continue;
    const double written_s = 3.0 * kPeriod * (i / 3) + (i % 3 == 0 ? 0.0 : i % 3 == 1 ? 0.03 : 0.14);
    const TrackerStep step =
        tracker.add({toy_scan(walls, {3.0 + 0.06 * i, 0, 0}, lidar, random, stamp_from_seconds(written_s))});
    off_m = std::abs(step.T_odom_mid.x - 0.06 * i);
  }
  return off_m;
}

TEST(Corridor, ScansLostFromALogThatIsWrittenInBurstsLeaveNoHole) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) EXPECT_LT(drive_with_losses(seed), 0.2) << seed;
}

TEST(Corridor, ShallowNichesShowTheWayAlongIt) {
  // Lost by 17 m of 12 where hits only count by their distance from the nearest line.
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    EXPECT_LT(drive_past_niches(0.1, seed, false), 0.5) << seed;
    EXPECT_LT(drive_past_niches(0.2, seed, false), 0.3) << seed;
  }
}

/// How far off a robot is that sets off at once in a bare corridor, its wheels true.
double set_off(double step_m, std::uint64_t seed) {
  const ToyLidar lidar{.beams = 180, .range_max = 4.0, .field = kPi};
  Random random(seed);
  Tracker tracker;
  double x = 0.0, found = 0.0;
  for (int i = 0; i < 30; ++i) {
    if (i > 10) x += step_m;
    const Scan scan = toy_scan(corridor(), {6.0 + x, 0, 0}, lidar, random, stamp_from_seconds(0.1 * i));
    found = tracker.add({scan, "", {}, Pose2{x, 0, 0}}).T_odom_mid.x;
  }
  return std::abs(found - x);
}

TEST(Corridor, WheelsThatWereRightAreFollowedAtOnceWhenTheSpeedChanges) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_LT(set_off(0.05, seed), 0.04) << seed;
    EXPECT_LT(set_off(0.12, seed), 0.2) << seed;
  }
}

TEST(Corridor, WheelsAreTrustedUntilScansDisagree) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) EXPECT_LT(drive_past_niches(0.0, seed, true), 0.3) << seed;
}

/// What poses along a map, made from eight poses, say of a scan whose prior is `off` ahead.
DirectionFit fit_in(const std::vector<Wall>& walls, double off) {
  const ToyLidar lidar{.beams = 720, .range_max = 4.0};
  Random random(3);
  SurfaceWorkspace work;
  SurfacePoints surface;
  MapPoints points;
  const auto see = [&](double x) {
    find_surface(toy_scan(walls, {x, 0, 0}, lidar, random, 0), {}, work, surface, kTrackingLines);
    to_map_points(surface, {}, 30.0, points);
  };
  LocalMap map;
  map.reset({}, 35.0, 0.1);
  for (int k = 0; k < 8; ++k) {
    see(6.0 + 0.25 * k);
    map.add(points, {0.25 * k, 0, 0});
  }
  map.finish();
  see(7.8);
  PosePrior prior;
  prior.T_map_base = {1.8 + off, 0, 0};
  prior.information.diagonal() << 1.0, 1.0, 1.0;
  return fit_along(map, points, prior.T_map_base, {1.0, 0.0, 0.0}, prior);
}

TEST(FitAlong, NichesSayWhereAndBareWallsSayNothing) {
  for (const double off : {-0.15, -0.05, 0.0, 0.1, 0.15}) {
    const DirectionFit niche = fit_in(corridor_with_niches(40.0, 0.3), off), bare = fit_in(corridor(), off);
    EXPECT_NEAR(niche.offset_m, -off, 0.04) << off;
    EXPECT_GT(kMatchTrust * niche.information, 50.0) << off;
    EXPECT_LT(kMatchTrust * bare.information, 20.0) << off;
    EXPECT_LT(std::abs(bare.offset_m), 0.06) << off;
  }
}

TEST(FitAlong, AnswersWithoutPointsAndWithoutMap) {
  const DirectionFit fit = fit_along(LocalMap{}, MapPoints{}, {}, {1.0, 0.0, 0.0}, {});
  EXPECT_NEAR(fit.offset_m, 0.0, 1e-9);
  EXPECT_TRUE(std::isfinite(fit.information));
}

}  // namespace
}  // namespace phasescan::corridor_test
