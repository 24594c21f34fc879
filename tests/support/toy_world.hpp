// A small world of walls and a lidar in it: enough to test trackers without the simulator.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::testing {

struct Wall {
  Eigen::Vector2d a, b;
};

/// Two rooms of 6 x 5 m joined by a door, with a cupboard and a slanted wall, so that no place looks like another.
inline std::vector<Wall> two_rooms() {
  std::vector<Wall> walls;
  const auto add = [&](double x1, double y1, double x2, double y2) { walls.push_back({{x1, y1}, {x2, y2}}); };
  add(-3, -2.5, 9, -2.5), add(9, -2.5, 9, 2.5), add(9, 2.5, -3, 2.5), add(-3, 2.5, -3, -2.5);
  add(3, -2.5, 3, -0.6), add(3, 0.6, 3, 2.5);
  add(-3, 1.5, -2, 1.5), add(-2, 1.5, -2, 2.5);
  add(7.5, -2.5, 9, -1.2), add(5, 2.5, 5, 2.1), add(5, 2.1, 6.2, 2.1), add(6.2, 2.1, 6.2, 2.5);
  return walls;
}

/// The four sides of a thing.
inline void add_box(std::vector<Wall>& walls, double x1, double y1, double x2, double y2) {
  walls.push_back({{x1, y1}, {x2, y1}});
  walls.push_back({{x2, y1}, {x2, y2}});
  walls.push_back({{x2, y2}, {x1, y2}});
  walls.push_back({{x1, y2}, {x1, y1}});
}

/// A corridor from x = 0 to `end`, 1.8 m wide, with a niche 0.8 m wide every 3 m on either side.
inline std::vector<Wall> corridor_with_niches(double end, double depth) {
  std::vector<Wall> walls = {{{0, -0.9}, {0, 0.9}}, {{end, -0.9}, {end, 0.9}}};
  for (const double side : {-1.0, 1.0}) {
    for (double x = side > 0 ? 1.0 : 0.0; x < end; x += 3.0) {
      const double front = 0.9 * side, back = (0.9 + depth) * side;
      walls.push_back({{x, front}, {x + 2.2, front}});
      walls.push_back({{x + 2.2, front}, {x + 2.2, back}});
      walls.push_back({{x + 2.2, back}, {x + 3.0, back}});
      walls.push_back({{x + 3.0, back}, {x + 3.0, front}});
    }
  }
  return walls;
}

inline double toy_range(const std::vector<Wall>& walls, const Eigen::Vector2d& from, double angle) {
  const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
  double best = std::numeric_limits<double>::infinity();
  for (const Wall& w : walls) {
    const Eigen::Vector2d e = w.b - w.a, r = w.a - from;
    const double det = d.x() * e.y() - d.y() * e.x();
    if (std::abs(det) < 1e-12) continue;
    const double t = (r.x() * e.y() - r.y() * e.x()) / det, u = (r.x() * d.y() - r.y() * d.x()) / det;
    if (t > 0.0 && u >= 0.0 && u <= 1.0) best = std::min(best, t);
  }
  return best;
}

struct ToyLidar {
  int beams = 360;
  double range_max = 8.0, noise = 0.008,
         turn_s = 0.0;  ///< not 0: beams are fired one after the other while the robot moves; < 0: the last one first
  double field = kTwoPi;
};

/// A scan from T_world_laser (at its first beam) while the laser moves with `twist`. With `flipped`, beams run
/// clockwise seen from above.
inline Scan toy_scan(const std::vector<Wall>& walls, const Pose2& T_world_laser, const ToyLidar& lidar, Random& random,
                     Stamp stamp, const Twist2& twist = {}, bool flipped = false) {
  ScanGeometry g;
  g.angle_min = -0.5 * lidar.field;
  g.angle_increment = lidar.field / lidar.beams;
  g.range_max = lidar.range_max;
  std::vector<float> ranges;
  for (int i = 0; i < lidar.beams; ++i) {
    const Pose2 pose =
        lidar.turn_s != 0.0 ? T_world_laser * exp_twist(twist, lidar.turn_s * i / lidar.beams) : T_world_laser;
    const double angle = g.angle_min + i * g.angle_increment;
    ranges.push_back(static_cast<float>(toy_range(walls, pose.translation(), pose.theta + (flipped ? -angle : angle)) +
                                        random.normal(0.0, lidar.noise)));
  }
  Scan scan = make_scan(ranges, g);
  scan.stamp = stamp;
  scan.time_increment = lidar.turn_s / lidar.beams;
  return scan;
}

/// A tour through both rooms and back, `laps` times: one pose per scan, `period_s` apart, at `speed` and at most
/// `turn_rate`.
inline std::vector<Pose2> toy_tour(double period_s, double speed, double turn_rate, int laps = 1) {
  const std::vector<Eigen::Vector2d> stops = {{0, 0},   {2.2, 0}, {4, 0},       {6.5, -1},   {7.2, 1}, {4.5, 0.9},
                                              {3.6, 0}, {2, 0.1}, {-1.5, -1.2}, {-1.6, 0.4}, {0, 0}};
  std::vector<Pose2> poses;
  Pose2 pose{0, 0, 0};
  poses.push_back(pose);
  for (int lap = 0; lap < laps; ++lap) {
    for (std::size_t s = 1; s < stops.size(); ++s) {
      while ((stops[s] - pose.translation()).norm() > 1.5 * speed * period_s) {
        const Eigen::Vector2d to = stops[s] - pose.translation();
        const double off = wrap_angle(std::atan2(to.y(), to.x()) - pose.theta);
        const double turn = std::max(-turn_rate * period_s, std::min(turn_rate * period_s, off));
        const double forward = std::abs(off) < 0.5 ? speed * period_s : 0.0;
        pose = pose * exp_twist({forward, 0.0, turn});
        poses.push_back(pose);
      }
    }
  }
  return poses;
}

}  // namespace phasescan::testing
