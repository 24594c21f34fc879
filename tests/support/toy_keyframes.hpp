// Keyframes of a drive through a toy world, without a tracker.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "odometry/map_points.hpp"
#include "scan/surface.hpp"
#include "slam/keyframe.hpp"
#include "support/toy_world.hpp"

namespace phasescan::testing {

/// Poses along straight ways between stops, `step_m` apart, turning on the spot at the stops by at most `step_rad`.
inline std::vector<Pose2> drive(const std::vector<Eigen::Vector2d>& stops, double step_m, double step_rad) {
  std::vector<Pose2> poses = {{stops[0].x(), stops[0].y(), 0.0}};
  for (std::size_t s = 1; s < stops.size(); ++s) {
    const Eigen::Vector2d way = stops[s] - stops[s - 1];
    const double heading = std::atan2(way.y(), way.x());
    const double turn = wrap_angle(heading - poses.back().theta), from = poses.back().theta;
    const int turns = static_cast<int>(std::ceil(std::abs(turn) / step_rad));
    for (int k = 1; k <= turns; ++k)
      poses.push_back({stops[s - 1].x(), stops[s - 1].y(), wrap_angle(from + turn * k / turns)});
    const int steps = static_cast<int>(std::ceil(way.norm() / step_m));
    for (int k = 1; k <= steps; ++k) {
      const Eigen::Vector2d p = stops[s - 1] + way * k / steps;
      poses.push_back({p.x(), p.y(), heading});
    }
  }
  return poses;
}

/// A keyframe at each pose. @param T_odom_of  where odometry has the k-th; exact where there is none
inline std::vector<Keyframe> toy_keyframes(const std::vector<Wall>& walls, const std::vector<Pose2>& poses,
                                           Random& random, const ToyLidar& lidar = {},
                                           const std::function<Pose2(std::size_t)>& T_odom_of = nullptr) {
  SurfaceWorkspace work;
  SurfacePoints surface;
  std::vector<Keyframe> out;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    find_surface(toy_scan(walls, poses[i], lidar, random, 0), {}, work, surface);
    auto points = std::make_shared<MapPoints>();
    to_map_points(surface, {}, 40.0, *points);
    Keyframe keyframe;
    keyframe.points = std::make_shared<const KeyframePoints>(*points);
    keyframe.T_odom_base = T_odom_of ? T_odom_of(i) : poses[i];
    keyframe.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
    keyframe.scan = static_cast<std::int64_t>(i);
    for (std::size_t k = 0; k < points->size(); ++k) keyframe.centre += Eigen::Vector2d(points->x[k], points->y[k]);
    keyframe.centre /= static_cast<double>(points->size());
    out.push_back(std::move(keyframe));
  }
  return out;
}

}  // namespace phasescan::testing
