/// Beams of one revolution, cast into a world.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "sim/lidar.hpp"
#include "sim/revolution.hpp"

namespace phasescan::sim {

/// The unit vector in a direction [rad].
Eigen::Vector2d unit(double angle);

/// What one beam looks along: an azimuth in the world and, where the sensor is tilted, how its range differs from that
/// of its shadow on the floor.
struct BeamRay {
  Eigen::Vector2d direction;
  double shadow = 1.0;                                     ///< length of the shadow of 1 m of beam
  double floor = std::numeric_limits<double>::infinity();  ///< range at which it meets the floor [m]
};

/// @param angle  of the beam in the world; with a tilt, in the sensor's plane
BeamRay beam_ray(const LidarOptions& lidar, const Pose2& pose, double angle);

/// What answers along a ray; its range is that of the beam itself.
RayHit cast_ray(const Surroundings& around, const LidarOptions& lidar, const Pose2& pose, const BeamRay& ray);

/// The geometry of one scan: where each beam starts and what it looks along.
struct Beams {
  std::vector<Pose2> poses;    ///< one, or one a beam
  std::vector<double> angles;  ///< in the world; with a tilt, in the sensor's plane
  std::vector<RayHit> hits;
  std::vector<bool> sampled;  ///< empty: all

  const Pose2& pose(std::size_t i) const { return poses[poses.size() > 1 ? i : 0]; }
};

/// Casts them all. @param dt  [s] between beams
Beams cast_beams(const Surroundings& around, const LidarOptions& lidar, const Revolution& revolution, double dt,
                 const std::function<Pose2(double)>& T_world_laser);

}  // namespace phasescan::sim
