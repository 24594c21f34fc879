#include "sim/beam_cast.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::sim {

using Eigen::Vector2d;

Vector2d unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

BeamRay beam_ray(const LidarOptions& lidar, const Pose2& pose, double angle) {
  const SensorEffects& effects = lidar.effects;
  if (effects.tilt_deg <= 0.0) return {unit(angle)};
  const double towards = deg_to_rad(effects.tilt_towards_deg), tilt = deg_to_rad(effects.tilt_deg);
  const double bearing = angle - pose.theta - towards, ahead = std::cos(bearing), aside = std::sin(bearing);
  BeamRay ray;
  ray.direction = unit(pose.theta + towards + std::atan2(aside, ahead * std::cos(tilt)));
  ray.shadow = std::hypot(ahead * std::cos(tilt), aside);
  const double down = ahead * std::sin(tilt);
  if (down > 0.0) ray.floor = effects.height_m / down;
  return ray;
}

RayHit cast_ray(const Surroundings& around, const LidarOptions& lidar, const Pose2& pose, const BeamRay& ray) {
  RayHit hit = cast_beam(around, lidar, pose.translation(), ray.direction);
  hit.range /= ray.shadow;
  if (ray.floor < std::min(hit.range, lidar.range_max_m)) {
    hit.range = ray.floor;
    hit.cos_incidence = lidar.effects.height_m / ray.floor;
    hit.normal = -ray.direction;
    hit.material = Material::kMatt;
  }
  return hit;
}

Beams cast_beams(const Surroundings& around, const LidarOptions& lidar, const Revolution& revolution, double dt,
                 const std::function<Pose2(double)>& T_world_laser) {
  const auto count = static_cast<std::size_t>(lidar.beams);
  const double first = deg_to_rad(lidar.angle_min_deg), step = lidar.angle_increment();
  Beams beams;
  beams.poses.resize(lidar.motion ? count : 1);
  for (std::size_t i = 0; i < beams.poses.size(); ++i) beams.poses[i] = T_world_laser(static_cast<double>(i) * dt);
  beams.angles.resize(count);
  beams.hits.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    beams.angles[i] = beams.pose(i).theta + first + static_cast<double>(i) * step + revolution.turn;
    if (!revolution.offsets.empty()) {
      beams.sampled.resize(count);
      if (std::isnan(revolution.offsets[i])) continue;  // no sample, so no hit
      beams.sampled[i] = true;
      beams.angles[i] += revolution.offsets[i] * step;
    }
    beams.hits[i] = cast_ray(around, lidar, beams.pose(i), beam_ray(lidar, beams.pose(i), beams.angles[i]));
  }
  return beams;
}

}  // namespace phasescan::sim
