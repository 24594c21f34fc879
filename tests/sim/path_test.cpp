#include "sim/path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "sim/drive.hpp"
#include "sim/ray_caster.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim::path_test {
namespace {

using Eigen::Vector2d;

double least_clearance(const World& world, const Path& path) {
  const RayCaster caster(world.shape);
  double least = 1.0;
  for (double t = 0.0; t <= path.duration(); t += 0.05)
    least = std::min(least, caster.clearance(path.pose_at(t).translation(), 1.0));
  return least;
}

TEST(Path, ToursKeepClearSeeTheRoomsAndComeBack) {
  for (const WorldKind kind : {WorldKind::kFlat, WorldKind::kOffice, WorldKind::kBuilding}) {
    std::size_t visited = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= (kind == WorldKind::kBuilding ? 1U : 6U); ++seed) {
      const World world = make_world(kind, seed);
      PathOptions options;
      options.speed_mps = 1.0;
      options.turn_rate_dps = 180.0;
      const Path path(world, options, seed);
      EXPECT_GT(least_clearance(world, path), 0.12) << world.name;
      EXPECT_LT(translation_distance(path.pose_at(0.0), path.pose_at(path.duration())), 0.1) << world.name;
      std::set<std::size_t> rooms;
      for (double t = 0.0; t <= path.duration(); t += 0.1) {
        for (std::size_t r = 0; r < world.rooms.size(); ++r) {
          if (inside_polygon(world.rooms[r], path.pose_at(t).translation())) rooms.insert(r);
        }
      }
      visited += rooms.size();
      all += world.rooms.size();
    }
    // Some doors are closed or nearly so; most rooms can be entered.
    EXPECT_GT(static_cast<double>(visited), 0.6 * static_cast<double>(all)) << to_string(kind);
  }
}

TEST(Path, KeepsItsLimits) {
  PathOptions options;
  options.speed_mps = 0.5;
  options.turn_rate_dps = 90.0;
  const Path path(make_world(WorldKind::kFlat, 3), options, 9);
  double last_speed = path.twist_at(0.01).vx;
  for (double t = 0.02; t < path.duration() - 0.02; t += 0.01) {
    const Twist2 twist = path.twist_at(t);
    EXPECT_LE(twist.vx, 0.5 + 1e-6);
    EXPECT_LE(std::abs(twist.omega), deg_to_rad(90.0) + 1e-6);
    EXPECT_NEAR(twist.vx, last_speed, options.acceleration_mps2 * 0.0101 + 1e-6);
    last_speed = twist.vx;
  }
}

TEST(Path, CirclesHaveTheSpeedAndTheTurnAskedFor) {
  PathOptions options;
  options.kind = PathKind::kCircle;
  options.speed_mps = 0.3;
  options.turn_rate_dps = 60.0;
  options.duration_s = 20.0;
  const World world = make_world(WorldKind::kRoom, 5);
  const Path path(world, options, 2);
  EXPECT_NEAR(path.duration(), 20.0, 0.05);
  const Twist2 twist = path.twist_at(10.0);
  EXPECT_NEAR(twist.vx, 0.3, 1e-6);
  EXPECT_NEAR(std::abs(twist.omega), deg_to_rad(60.0), 1e-6);
  EXPECT_GT(least_clearance(world, path), 0.1);
}

TEST(Path, GoesBackTheWayItCame) {
  PathOptions options;
  options.kind = PathKind::kBackAndForth;
  options.duration_s = 60.0;
  const World world = make_world(WorldKind::kRoom, 5);
  const Path path(world, options, 2);
  bool forwards = false, backwards = false;
  for (double t = 0.0; t < path.duration(); t += 0.1) {
    forwards = forwards || path.twist_at(t).vx > 0.2;
    backwards = backwards || path.twist_at(t).vx < -0.2;
  }
  EXPECT_TRUE(forwards && backwards);
  EXPECT_GT(least_clearance(world, path), 0.15);
}

TEST(Path, JitterHasItsSizeAndLeavesTheWayAlone) {
  PathOptions options;
  options.kind = PathKind::kStand;
  options.duration_s = 120.0;
  options.jitter_m = 0.004;
  options.jitter_deg = 0.5;
  const Path path(make_world(WorldKind::kRoom, 1), options, 4);
  double sum = 0.0, sum2 = 0.0, turn2 = 0.0;
  int n = 0;
  const double heading = path.pose_at(0.0).theta;
  for (double t = 0.0; t < 119.0; t += 0.0137, ++n) {
    sum += path.pose_at(t).x;
    sum2 += path.pose_at(t).x * path.pose_at(t).x;
    turn2 += std::pow(wrap_angle(path.pose_at(t).theta - heading), 2);
  }
  EXPECT_NEAR(std::sqrt(sum2 / n - sum * sum / n / n), 0.004, 0.001);
  EXPECT_LT(std::sqrt(turn2 / n), deg_to_rad(1.2));
}

TEST(Path, PolylinesAreFollowed) {
  const std::vector<Vector2d> points{{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}, {0.0, 2.0}};
  const Path path(points, {}, 1);
  for (double t = 0.0; t < path.duration(); t += 0.1) {
    const Vector2d p = path.pose_at(t).translation();
    double off = 1e9;
    for (std::size_t i = 1; i < points.size(); ++i)
      off = std::min(off, point_segment_distance(p, points[i - 1], points[i]));
    EXPECT_LT(off, 0.12);
  }
  EXPECT_LT((path.pose_at(path.duration()).translation() - points.back()).norm(), 0.05);
  EXPECT_THROW(Path(std::vector<Vector2d>{{0.0, 0.0}}, {}, 1), std::invalid_argument);
}

TEST(Drive, TheSameSeedGivesTheSameDrive) {
  const World world = make_world(WorldKind::kFlat, 2);
  PathOptions options;
  options.duration_s = 5.0;
  DriveOptions what;
  what.people = 2;
  what.odometry = true;
  const auto drive = [&](std::uint64_t seed) {
    Drive run(world, LidarOptions{}, Path(world, options, seed), what, seed);
    std::vector<DriveScan> scans;
    while (auto scan = run.next()) scans.push_back(std::move(*scan));
    EXPECT_EQ(scans.size(), run.size());
    return scans;
  };
  const auto a = drive(3), b = drive(3), c = drive(4);
  ASSERT_EQ(a.size(), 27U);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].entry.scan.states, b[k].entry.scan.states);
    EXPECT_EQ(a[k].entry.odometry->x, b[k].entry.odometry->x);
    EXPECT_EQ(a[k].T_world_laser.x, b[k].T_world_laser.x);
    EXPECT_NEAR(stamp_to_seconds(a[k].entry.scan.stamp), static_cast<double>(k) / 5.5, 1e-9);
  }
  EXPECT_NE(a[0].T_world_laser.x, c[0].T_world_laser.x);
}

TEST(Drive, OneRoundIsTheBeginningOfALongerTour) {
  const World world = make_world(WorldKind::kFlat, 2);
  LidarOptions lidar;
  lidar.beams = 8;
  PathOptions options;
  Drive round(world, lidar, Path(world, options, 3), {}, 4);
  options.duration_s = round.path().duration() + 60.0;
  Drive longer(world, lidar, Path(world, options, 3), {}, 4);
  ASSERT_GT(longer.size(), round.size() + 100);
  while (const auto scan = round.next()) {
    const auto same = longer.next();
    ASSERT_TRUE(same);
    ASSERT_EQ(scan->entry.scan.stamp, same->entry.scan.stamp);
    ASSERT_EQ(scan->T_world_laser.x, same->T_world_laser.x);
    ASSERT_EQ(scan->entry.scan.states, same->entry.scan.states);
    for (std::size_t i = 0; i < scan->entry.scan.size(); ++i) {
      if (!scan->entry.scan.is_hit(i)) continue;
      ASSERT_EQ(scan->entry.scan.ranges[i], same->entry.scan.ranges[i]);
    }
  }
}

TEST(Drive, OdometryWithoutErrorsIsTheTruth) {
  const World world = make_world(WorldKind::kFlat, 2);
  PathOptions options;
  options.duration_s = 20.0;
  DriveOptions what;
  what.odometry = true;
  what.odometry_scale = what.odometry_noise = what.odometry_slip_per_min = 0.0;
  LidarOptions lidar;
  lidar.beams = 4;
  lidar.rate_hz = 100.0;
  Drive run(world, lidar, Path(world, options, 1), what, 1);
  const Pose2 start = run.path().pose_at(0.0);
  double travelled = 0.0;
  while (const auto scan = run.next()) {
    EXPECT_LT(translation_distance(start * *scan->entry.odometry, scan->T_world_laser), 0.01);
    travelled = translation_distance(start, scan->T_world_laser);
  }
  EXPECT_GT(travelled, 0.2);
}

}  // namespace
}  // namespace phasescan::sim::path_test
