#include "odometry/tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/motion.hpp"
#include "support/toy_world.hpp"

namespace phasescan::tracker_test {
namespace {

using testing::toy_scan;
using testing::toy_tour;
using testing::ToyLidar;
using testing::two_rooms;

constexpr double kPeriod = 0.18;

struct Drive {
  double worst_m = 0.0, worst_rad = 0.0;
  std::size_t untracked = 0;
  WheelCounts wheels;
};

/// Drives the tour and compares each pose with the truth (both start at the first pose).
template <class Wheels>
Drive drive(const OdometryOptions& options, const ToyLidar& lidar, const Pose2& T_base_laser, double speed,
            double turn_rate, Wheels&& wheels, bool upside_down = false) {
  const auto walls = two_rooms();
  const auto tour = toy_tour(kPeriod, speed, turn_rate);
  Random random(21);
  Tracker tracker(options);
  Drive out;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    // The motion during the turn: it begins with the stamp, or ends with it where the last beam is fired first.
    const std::size_t from = lidar.turn_s < 0.0 ? i - std::min<std::size_t>(i, 1) : i;
    const Twist2 step = log_pose(tour[from].inverse() * tour[std::min(from + 1, tour.size() - 1)]);
    const Twist2 twist{step.vx / kPeriod, step.vy / kPeriod, step.omega / kPeriod};
    Scan scan = toy_scan(walls, tour[i] * T_base_laser, lidar, random,
                         stamp_from_seconds(100.0 + kPeriod * static_cast<double>(i)),
                         twist_of_frame(T_base_laser, twist), upside_down);
    if (upside_down) scan = mirrored_scan(scan);
    const TrackerStep found = tracker.add({scan, "", T_base_laser, wheels(i, tour)});
    const Pose2 truth = tour[0].inverse() * tour[i];
    out.worst_m = std::max(out.worst_m, translation_distance(found.T_odom_stamp, truth));
    out.worst_rad = std::max(out.worst_rad, angle_distance(found.T_odom_stamp.theta, truth.theta));
    out.untracked += !found.tracked();
  }
  out.wheels = tracker.state().motion.wheels.counts;
  return out;
}

const auto kNoWheels = [](std::size_t, const std::vector<Pose2>&) { return std::optional<Pose2>(); };

TEST(Tracker, FollowsATourWithScansAlone) {
  const Drive d = drive({}, {}, {}, 0.4, 1.2, kNoWheels);
  EXPECT_LT(d.worst_m, 0.04);
  EXPECT_LT(d.worst_rad, 0.015);
  EXPECT_EQ(d.untracked, 0u);
}

TEST(Tracker, DeskewsATurningLidarAndTheSwitchTurnsItOff) {
  ToyLidar lidar;
  lidar.turn_s = kPeriod;
  const Drive with = drive({}, lidar, {}, 0.5, 1.5, kNoWheels);
  EXPECT_LT(with.worst_m, 0.06);
  OdometryOptions off;
  off.deskew = false;
  const Drive without = drive(off, lidar, {}, 0.5, 1.5, kNoWheels);
  EXPECT_GT(without.worst_m, 1.4 * with.worst_m);
}

TEST(Tracker, BeamsListedLastToFirstAreDeskewedAsWell) {
  ToyLidar lidar;
  lidar.turn_s = -kPeriod;
  const Drive d = drive({}, lidar, {}, 0.5, 1.5, kNoWheels);
  // The stamp lies ahead of what was seen: half a turn's motion where the robot sets off or stops. Behind by a turn it
  // was 0.11 m and 0.29 rad.
  EXPECT_LT(d.worst_m, 0.08);
  EXPECT_LT(d.worst_rad, 0.15);
}

TEST(Tracker, MountedSidewaysAndUpsideDown) {
  const Drive d = drive({}, {}, {0.3, -0.1, 2.0}, 0.4, 1.2, kNoWheels, true);
  EXPECT_LT(d.worst_m, 0.05);
  EXPECT_LT(d.worst_rad, 0.015);
}

TEST(Tracker, LyingWheelsAreOutvoted) {
  // Wheels that count backwards steps as forward ones and drift to the side.
  Pose2 wheels;
  const auto lying = [&](std::size_t i, const std::vector<Pose2>& tour) {
    if (i > 0) {
      const Pose2 step = tour[i - 1].inverse() * tour[i];
      wheels = wheels * Pose2{i % 40 > 25 ? -step.x : step.x, step.y, step.theta};
    }
    return std::optional<Pose2>(wheels);
  };
  const Drive d = drive({}, {}, {}, 0.4, 1.2, lying);
  EXPECT_LT(d.worst_m, 0.06);
  EXPECT_GT(d.wheels.reversed, 10u);
  EXPECT_GT(d.wheels.agreed, 50u);
}

TEST(Tracker, JumpingWheelsAreNoticed) {
  const auto jumping = [&](std::size_t i, const std::vector<Pose2>& tour) {
    return std::optional<Pose2>(i > 50 ? Pose2{50.0, -20.0, 1.0} * tour[i] : tour[i]);
  };
  const Drive d = drive({}, {}, {}, 0.4, 1.2, jumping);
  EXPECT_LT(d.worst_m, 0.04);
  EXPECT_EQ(d.wheels.jumped, 1u);
}

TEST(Tracker, HoldsStillAtRest) {
  const auto walls = two_rooms();
  Random random(2);
  Tracker tracker;
  double farthest = 0.0;
  for (int i = 0; i < 300; ++i) {
    const TrackerStep step = tracker.add({toy_scan(walls, {0, 0, 0.2}, {}, random, stamp_from_seconds(0.1 * i))});
    farthest = std::max(farthest, std::hypot(step.T_odom_mid.x, step.T_odom_mid.y));
    if (i > 200) {
      EXPECT_LT(std::abs(step.T_odom_mid.theta), 0.001);
    }
  }
  EXPECT_LT(farthest, 0.006);
}

TEST(Tracker, HostileScansNeverBreakIt) {
  const auto walls = two_rooms();
  Random random(5);
  Tracker tracker;
  const ScanGeometry g{-kPi, kTwoPi / 90, 0.0, 0.0};
  for (int i = 0; i < 120; ++i) {
    Scan scan;
    switch (i % 6) {
      case 0:
        break;  // no beams at all
      case 1:
        scan = make_scan(std::vector<float>(90, 0.0F), g);
        break;  // nothing seen
      case 2:
        scan = make_scan(std::vector<float>(90, 1e30F), g);
        break;  // nonsense
      case 3: {
        std::vector<float> noise(90);
        for (float& r : noise) r = static_cast<float>(random.uniform(0.05, 20.0));
        scan = make_scan(noise, g);
        break;
      }
      case 4:
        scan = make_scan(std::vector<float>(1, 2.0F), g);
        break;
      default:
        scan = toy_scan(walls, {0, 0, 0}, {}, random, 0);
        break;
    }
    scan.stamp = i % 7 == 0 ? -1'000'000'000'000 : stamp_from_seconds(0.1 * i);
    const TrackerStep step =
        tracker.add({scan, "", {}, i % 5 == 0 ? std::optional<Pose2>(Pose2{1e8, std::nan(""), 0}) : std::nullopt});
    EXPECT_TRUE(step.T_odom_mid.is_finite());
    EXPECT_TRUE(step.T_odom_stamp.is_finite());
    EXPECT_TRUE(step.information.allFinite());
  }
}

TEST(Tracker, TwoLasersThatShareNoViewAreNotTurnedAbout) {
  // Front and rear half of a room that looks alike after half a turn; neither sees what the other does.
  std::vector<testing::Wall> walls{
      {{-4.5, -3.1}, {4.5, -3.1}}, {{4.5, -3.1}, {4.5, 3.1}}, {{4.5, 3.1}, {-4.5, 3.1}}, {{-4.5, 3.1}, {-4.5, -3.1}}};
  testing::add_box(walls, 2.0, 2.3, 2.6, 2.9);
  testing::add_box(walls, -2.9, -2.8, -2.2, -2.2);
  const ToyLidar half{.beams = 270, .range_max = 12.0, .field = kPi};
  const std::pair<std::string, Pose2> lasers[] = {{"front", {0.2, 0.0, 0.0}}, {"rear", {-0.2, 0.0, kPi}}};
  Random random(5);
  Tracker tracker;
  Pose2 truth;
  double farthest = 0.0;
  for (int i = 0; i < 120; ++i) {
    truth = truth * Pose2{0.02, 0.0, i > 40 && i < 90 ? 0.02 : 0.0};
    for (const auto& [name, T_base_laser] : lasers) {
      const Stamp stamp = stamp_from_seconds(0.05 * i + (name == "rear" ? 1e-6 : 0.0));
      const TrackerStep step =
          tracker.add({toy_scan(walls, truth * T_base_laser, half, random, stamp), name, T_base_laser});
      farthest = std::max(farthest, translation_distance(Pose2{0.02, 0.0, 0.0} * step.T_odom_mid, truth));
    }
  }
  EXPECT_LT(farthest, 0.1);
}

TEST(Tracker, AMountingThatJittersIsTheSameLaser) {
  // A transform that is looked up anew for each scan differs in its last bits, and a laser that pans in more than that.
  const auto walls = two_rooms();
  const auto tour = toy_tour(kPeriod, 0.4, 1.2);
  const ToyLidar half{.beams = 270, .range_max = 8.0, .field = kPi};
  for (const double pan : {0.0, 0.3}) {
    Random random(9), still_random(9);
    Tracker tracker, still;
    double worst_m = 0.0, still_m = 0.0;
    std::size_t keyframes = 0, still_keyframes = 0;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      const Stamp stamp = stamp_from_seconds(kPeriod * static_cast<double>(i));
      const double jitter = 1e-15 * static_cast<double>(i % 7);
      const Pose2 mounted{0.2, 0.0, 0.0},
          moved{0.2 + jitter, jitter, jitter + pan * std::sin(0.2 * static_cast<double>(i))};
      const Pose2 truth = tour[0].inverse() * tour[i];
      const TrackerStep one = tracker.add({toy_scan(walls, tour[i] * moved, half, random, stamp), "front", moved});
      const TrackerStep other =
          still.add({toy_scan(walls, tour[i] * mounted, half, still_random, stamp), "front", mounted});
      keyframes += one.keyframe, still_keyframes += other.keyframe;
      worst_m = std::max(worst_m, translation_distance(one.T_odom_stamp, truth));
      still_m = std::max(still_m, translation_distance(other.T_odom_stamp, truth));
      EXPECT_TRUE(one.tracked()) << i;
    }
    // A laser heard for the first time brings a keyframe: here that would be every scan.
    EXPECT_NEAR(static_cast<double>(keyframes), static_cast<double>(still_keyframes),
                0.1 * static_cast<double>(still_keyframes));
    EXPECT_LT(worst_m, still_m + 0.02) << pan;
  }
}

TEST(MapPoints, HitsThatScatterAlongTheirBeamsAreNoWall) {
  // Up and down, and by chance one after the other.
  for (const std::vector<float>& off :
       {std::vector<float>{0.02F, -0.015F, 0.01F, -0.02F, 0.015F}, std::vector<float>{0.02F, 0.0F, -0.02F}}) {
    Random random(1);
    Scan scan = toy_scan({{{0.0, 0.0}, {0.0, 0.0}}}, {}, {.beams = 682, .range_max = 4.0, .field = 4.19}, random, 0);
    const auto side = static_cast<std::size_t>(scan.size() * 7 / 8);  // to the left of the sensor
    for (std::size_t k = 0; k < off.size(); ++k) {
      scan.ranges[side + k] = 0.6F + off[k];
      scan.states[side + k] = BeamState::kHit;
    }
    SurfaceWorkspace work;
    SurfacePoints surface;
    find_surface(scan, {}, work, surface, kTrackingLines);
    MapPoints points;
    to_map_points(surface, {}, 10.0, points);
    ASSERT_EQ(points.size(), off.size());
    for (std::size_t k = 0; k < points.size(); ++k) EXPECT_TRUE(points.lone(k)) << off.size() << " " << k;
  }
}

TEST(Tracker, RefusesOptionsOutOfBounds) {
  OdometryOptions options;
  options.cell_m = 0.0;
  EXPECT_THROW(Tracker{options}, std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::tracker_test
