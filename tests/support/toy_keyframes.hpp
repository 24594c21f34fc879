// Keyframes of a drive through a toy world, without a tracker.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "odometry/map_points.hpp"
#include "scan/surface.hpp"
#include "slam/keyframe.hpp"
#include "support/toy_world.hpp"

namespace phasescan::testing {

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
