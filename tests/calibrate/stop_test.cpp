#include "calibrate/stop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibrate/beams.hpp"
#include "calibrate/stops_log.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan::stop_test {
namespace {

/// What a sensor sees on a way, each scan from one place.
std::vector<LogEntry> way(const std::vector<Pose2>& poses, const sim::LidarOptions& lidar, bool wheels = false) {
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, 3);
  const sim::RayCaster caster(world.shape);
  Random start(3);
  const Pose2 T_world_start = *sim::draw_pose(world, caster, 0.6, start);
  sim::RevolutionSource source(lidar, 8);
  std::vector<LogEntry> entries;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    Random random(Random::derive(5, k));
    const Pose2 pose = T_world_start * poses[k];
    LogEntry entry;
    entry.scan = sim::simulate_scan(
        {&caster, nullptr}, lidar, source, 1.0 / lidar.rate_hz, [&](double) { return pose; },
        static_cast<double>(k) / lidar.rate_hz, random);
    if (wheels) entry.odometry = poses[k];
    entries.push_back(entry);
  }
  return entries;
}

std::vector<Stop> stops_of(const std::vector<LogEntry>& entries) {
  StopFinder finder;
  std::vector<Stop> stops;
  for (const LogEntry& entry : entries) {
    if (auto stop = finder.add(entry.scan, entry.odometry)) stops.push_back(*stop);
  }
  if (auto stop = finder.finish()) stops.push_back(*stop);
  return stops;
}

TEST(SmallMotion, IsThatOfTheSensor) {
  const sim::LidarOptions lidar = sim::LidarOptions{}.noise_free();
  for (const Pose2& moved :
       {Pose2{0.02, 0.0, 0.0}, Pose2{0.0, -0.015, 0.0}, Pose2{0.0, 0.0, 0.01}, Pose2{0.01, 0.02, -0.008}}) {
    const auto scans = way({Pose2{}, moved}, lidar);
    const Stop grid = grid_of(scans[0].scan);
    const SmallMotion got = small_motion(grid, on_grid(scans[0].scan, grid), on_grid(scans[1].scan, grid));
    EXPECT_NEAR(got.x, moved.x, 0.002);
    EXPECT_NEAR(got.y, moved.y, 0.002);
    EXPECT_NEAR(got.theta, moved.theta, 0.001);
    EXPECT_GT(got.agreeing, 0.9);
  }
}

TEST(StopFinder, TakesStopsAndLeavesDrives) {
  std::vector<Pose2> poses;
  for (int k = 0; k < 20; ++k) poses.push_back({});
  for (int k = 0; k < 20; ++k) poses.push_back({0.03 * k, 0.0, 0.0});
  for (int k = 0; k < 30; ++k) poses.push_back({0.6, 0.0, 0.0});
  for (const bool wheels : {false, true}) {
    const auto stops = stops_of(way(poses, sim::read_lidar("rplidar-a1-real"), wheels));
    ASSERT_EQ(stops.size(), 2U) << wheels;
    EXPECT_NEAR(static_cast<double>(stops[0].size()), wheels ? 19.0 : 15.0, 1.5);
    EXPECT_NEAR(static_cast<double>(stops[1].size()), wheels ? 28.0 : 24.0, 2.5);
    EXPECT_TRUE(stops[0].closed);
    EXPECT_EQ(stops[0].beams, 360U);
  }
}

TEST(StopFinder, ARobotThatCreepsDoesNotStand) {
  for (const double speed : {0.0005, 0.001, 0.003}) {  // metres a scan
    std::vector<Pose2> poses;
    for (int k = 0; k < 100; ++k) poses.push_back({speed * k, 0.0, 0.0});
    EXPECT_TRUE(stops_of(way(poses, sim::read_lidar("ld06"))).empty()) << speed;
  }
}

TEST(StopFinder, WrongScansNeitherEndAStopNorEnterIt) {
  sim::LidarOptions lidar = sim::read_lidar("ld06");
  lidar.effects.wrong_start = 0.1;
  const auto stops = stops_of(way(std::vector<Pose2>(100), lidar, true));
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_LT(stops[0].size(), 98U);
  EXPECT_GT(stops[0].size(), 75U);
  const StopBeams beams = summarise(stops[0]);
  const ScanTurns turns = scan_turns(
      beams, [](double) { return 1e-4; }, 0.0);
  for (const double turn : turns.turns) EXPECT_LT(std::abs(turn), 1.0);
}

TEST(StopFinder, RepeatedScansCountOnce) {
  auto entries = way(std::vector<Pose2>(20), sim::read_lidar("ld06"), true);
  const auto once = stops_of(entries);
  std::vector<LogEntry> doubled;
  for (const LogEntry& entry : entries) doubled.insert(doubled.end(), 2, entry);
  const auto twice = stops_of(doubled);
  ASSERT_EQ(once.size(), 1U);
  ASSERT_EQ(twice.size(), 1U);
  EXPECT_EQ(once[0].size(), twice[0].size());
}

TEST(OnGrid, EachHitGoesToTheNearestBeam) {
  Stop grid;
  grid.angle_min = 0.0;
  grid.step = -kTwoPi / 8.0;
  grid.beams = 8;
  grid.closed = true;
  const std::vector<float> raw{1.0F, 2.0F, 3.0F, 4.0F};
  const std::vector<float> angles{0.05F, static_cast<float>(-kPi / 2.0 + 0.1), static_cast<float>(kPi / 2.0),
                                  static_cast<float>(3.0 * kPi)};
  const auto got = on_grid(make_scan(raw, {0.0, 0.1, 0.0, 10.0}, angles), grid);
  EXPECT_EQ(got[0], 1.0F);
  EXPECT_EQ(got[2], 2.0F);
  EXPECT_EQ(got[6], 3.0F);
  EXPECT_EQ(got[4], 4.0F);
  EXPECT_TRUE(std::isnan(got[1]) && std::isnan(got[3]) && std::isnan(got[5]) && std::isnan(got[7]));
}

/// A stop in a round room: every beam says the same range.
Stop round_stop(std::size_t scans, std::size_t beams = 360, float range = 2.0F) {
  Stop stop;
  stop.angle_min = 0.0;
  stop.step = kTwoPi / static_cast<double>(beams);
  stop.beams = beams;
  stop.closed = true;
  stop.ranges.assign(scans, std::vector<float>(beams, range));
  return stop;
}

TEST(StopBeams, SectorsThatAreSilentAtOnceAreLost) {
  Stop stop = round_stop(12);
  for (std::size_t i = 100; i < 160; ++i) stop.ranges[3][i] = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t k = 0; k < 12; ++k) stop.ranges[k][200 + k] = std::numeric_limits<float>::quiet_NaN();
  const StopBeams beams = summarise(stop);
  ASSERT_EQ(beams.lost.size(), 1U);
  EXPECT_EQ(beams.lost[0].scan, 3U);
  EXPECT_EQ(beams.lost[0].first, 100U);
  EXPECT_EQ(beams.lost[0].count, 60U);
  EXPECT_EQ(beams.beams[120].asked, 11U);
  EXPECT_EQ(beams.beams[120].answers, 11U);
  EXPECT_EQ(beams.beams[205].asked, 12U);
  EXPECT_EQ(beams.beams[205].answers, 11U);
}

TEST(StopBeams, ATurnIsReadFromSlopes) {
  Stop stop = round_stop(11);
  const auto range = [](double i) { return 2.0 + 0.8 * std::sin(kTwoPi * i / 90.0); };
  const double turns[] = {0.0, 0.3, -0.3, 0.1, -0.1, 0.2, -0.2, 0.0, 0.05, -0.05, 0.0};
  for (std::size_t k = 0; k < 11; ++k) {
    for (std::size_t i = 0; i < 360; ++i)
      stop.ranges[k][i] = static_cast<float>(range(static_cast<double>(i) + turns[k]));
  }
  const ScanTurns got = scan_turns(
      summarise(stop), [](double) { return 1e-4; }, 0.01);
  for (std::size_t k = 0; k < 11; ++k) EXPECT_NEAR(got.turns[k], turns[k], 0.01) << k;
}

}  // namespace
}  // namespace phasescan::stop_test
