// Logs of toy worlds with everything in them that trackers meet: wheels, two lasers, gaps, scans with nothing in them.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/motion.hpp"
#include "phasescan/scan/scan.hpp"
#include "support/toy_world.hpp"

namespace phasescan::testing {

struct ToyLog {
  std::string name;
  std::vector<RangeMeasurement> measurements;
  std::vector<Pose2> truth;  ///< T_world_base at each stamp
};

/// A tour through two rooms with a lidar that turns while the robot moves, and no wheels.
inline ToyLog turning_lidar_log(std::size_t scans, std::uint64_t seed = 3) {
  ToyLog log{"turning lidar", {}, {}};
  Random random(seed);
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.5, 1.5);
  ToyLidar lidar;
  lidar.turn_s = 0.18;
  for (std::size_t i = 0; i + 1 < tour.size() && i < scans; ++i) {
    const Twist2 twist = mean_twist(tour[i].inverse() * tour[i + 1], 0.18);
    const Stamp stamp = stamp_from_seconds(10.0 + 0.18 * static_cast<double>(i));
    log.measurements.push_back({toy_scan(walls, tour[i], lidar, random, stamp, twist)});
    log.truth.push_back(tour[i]);
  }
  return log;
}

/// The same tour with wheels that slip, count backwards and jump.
inline ToyLog wheels_log(std::size_t scans, std::uint64_t seed = 4) {
  ToyLog log{"wheels", {}, {}};
  Random random(seed);
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.4, 1.2);
  Pose2 wheels;
  for (std::size_t i = 0; i < tour.size() && i < scans; ++i) {
    if (i > 0) {
      const Pose2 step = tour[i - 1].inverse() * tour[i];
      wheels = wheels * Pose2{(i % 40 > 30 ? -1.0 : 1.02) * step.x, step.y, step.theta};
    }
    if (i == 50) wheels = Pose2{50.0, -20.0, 1.0} * wheels;
    RangeMeasurement m{toy_scan(walls, tour[i], {}, random,
                                stamp_from_seconds(0.18 * static_cast<double>(i) + (i % 2 == 0 ? 0.0 : 0.01)))};
    if (i % 17 != 5) m.T_odom_base = wheels;
    log.measurements.push_back(std::move(m));
    log.truth.push_back(tour[i]);
  }
  return log;
}

/// Two lasers that share no view, of which one jitters and the other pans; the second is heard after a while.
inline ToyLog two_lasers_log(std::size_t scans, std::uint64_t seed = 5) {
  ToyLog log{"two lasers", {}, {}};
  Random random(seed);
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.4, 1.2);
  const ToyLidar half{.beams = 270, .range_max = 8.0, .field = kPi};
  for (std::size_t i = 0; i < tour.size() && log.truth.size() < scans; ++i) {
    const Stamp stamp = stamp_from_seconds(0.18 * static_cast<double>(i));
    const Pose2 front{0.2, 0.0, 1e-15 * static_cast<double>(i % 5)},
        rear{-0.2, 0.0, wrap_angle(kPi + 0.2 * std::sin(0.1 * static_cast<double>(i)))};
    log.measurements.push_back({toy_scan(walls, tour[i] * front, half, random, stamp), "front", front});
    log.truth.push_back(tour[i]);
    if (i < 10) continue;
    log.measurements.push_back({toy_scan(walls, tour[i] * rear, half, random, stamp + 1000), "rear", rear});
    log.truth.push_back(tour[i]);
  }
  return log;
}

/// Empty scans, scans with no return, repeated stamps, minutes without a scan and a robot that is carried elsewhere.
inline ToyLog broken_log(std::size_t scans, std::uint64_t seed = 6) {
  ToyLog log{"broken", {}, {}};
  Random random(seed);
  const auto walls = two_rooms();
  const auto elsewhere = corridor_with_niches(20.0, 0.3);
  const auto tour = toy_tour(0.18, 0.4, 1.2);
  double now = 1.0;
  for (std::size_t i = 0; i < tour.size() && i < scans; ++i) {
    now += i % 11 == 3 ? 0.0 : 0.18;
    if (i == 60) now += 100.0;
    const bool carried = i > 60 && i < 90;
    const Pose2 pose = carried ? Pose2{7.0, 0.1, 2.0} : tour[i];
    RangeMeasurement m{toy_scan(carried ? elsewhere : walls, pose, {}, random, stamp_from_seconds(now))};
    if (i < 2 || i == 30) m.scan = Scan{};
    if (i == 31 || (i > 100 && i < 112)) m.scan = make_scan(std::vector<float>(100, 0.0F), {-1.0, 0.01, 0.0, 0.0});
    m.scan.stamp = stamp_from_seconds(now);
    log.measurements.push_back(std::move(m));
    log.truth.push_back(pose);
  }
  return log;
}

/// A scan every 0.4 m: the motion so far says little of the next.
inline ToyLog sparse_log(std::size_t scans, std::uint64_t seed = 7) {
  ToyLog log{"sparse", {}, {}};
  Random random(seed);
  const auto walls = two_rooms();
  const auto tour = toy_tour(1.0, 0.4, 1.2);
  for (std::size_t i = 0; i < tour.size() && i < scans; ++i) {
    log.measurements.push_back(
        {toy_scan(walls, tour[i], {}, random, stamp_from_seconds(1.0 * static_cast<double>(i)))});
    log.truth.push_back(tour[i]);
  }
  return log;
}

/// A corridor with shallow niches where somebody walks ahead, the robot stopping now and then.
inline ToyLog corridor_log(std::size_t scans, std::uint64_t seed = 8) {
  ToyLog log{"corridor", {}, {}};
  Random random(seed);
  const ToyLidar lidar{.beams = 180, .range_max = 4.0, .field = kPi};
  double x = 1.5;
  for (std::size_t i = 0; i < scans; ++i) {
    auto walls = corridor_with_niches(30.0, 0.15);
    const double person = x + 1.1 + 0.15 * std::sin(0.05 * static_cast<double>(i));
    add_box(walls, person - 0.1, -0.2, person + 0.1, 0.0);
    if (i % 50 > 12) x += 0.05;
    log.measurements.push_back(
        {toy_scan(walls, {x, 0, 0}, lidar, random, stamp_from_seconds(0.1 * static_cast<double>(i)))});
    log.truth.push_back({x, 0, 0});
  }
  return log;
}

inline std::vector<ToyLog> toy_logs(std::size_t scans) {
  return {turning_lidar_log(scans), wheels_log(scans), two_lasers_log(scans),
          broken_log(scans),        sparse_log(scans), corridor_log(scans)};
}

}  // namespace phasescan::testing
