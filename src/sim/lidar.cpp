#include "sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

Vector2d unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// A mixed pixel: where the two rims of a beam meet surfaces at different ranges the sensor says one, or something
/// between.
double mix_rims(const Surroundings& around, const LidarOptions& lidar, const Pose2& pose, double angle, double range,
                Random& random) {
  constexpr double kEdge_m = 0.08;
  const double half = 0.5 * deg_to_rad(lidar.beam_width_deg);
  const RayHit left = cast_beam(around, lidar, pose.translation(), unit(angle + half));
  const RayHit right = cast_beam(around, lidar, pose.translation(), unit(angle - half));
  if (!left.found() || !right.found() || std::abs(left.range - right.range) < kEdge_m) return range;
  if (!random.chance(lidar.mixed_pixels)) return range;
  return left.range + (right.range - left.range) * random.uniform();
}

/// What the sensor says to a true range; 0 = nothing.
float measured(const LidarOptions& lidar, double range, Random& random) {
  double value = random.normal(range, lidar.sigma(range));
  if (lidar.resolution_m > 0.0) value = std::round(value / lidar.resolution_m) * lidar.resolution_m;
  return value >= lidar.range_min_m && value <= lidar.range_max_m ? static_cast<float>(value) : 0.0F;
}

}  // namespace

double LidarOptions::angle_increment() const {
  const int steps = fov_deg >= 360.0 ? beams : std::max(1, beams - 1);
  const double step = deg_to_rad(fov_deg) / steps;
  return clockwise ? -step : step;
}

double LidarOptions::time_increment() const {
  return std::abs(angle_increment()) / kTwoPi / rate_hz;
}

ScanGeometry LidarOptions::geometry() const {
  return {deg_to_rad(angle_min_deg), angle_increment(), range_min_m, range_max_m};
}

double LidarOptions::sigma(double range) const {
  return std::max(sigma_m, sigma_relative * range);
}

LidarOptions LidarOptions::noise_free() const {
  LidarOptions clean = *this;
  clean.sigma_m = clean.sigma_relative = clean.resolution_m = clean.dropout = clean.mixed_pixels = 0.0;
  clean.grazing_deg = 90.0;
  return clean;
}

RayHit Surroundings::cast(const Vector2d& origin, const Vector2d& direction, double max_range, double min_range) const {
  RayHit hit = fixed ? fixed->cast(origin, direction, max_range, min_range) : RayHit{};
  if (loose && !loose->empty()) {
    const RayHit other = cast_all(*loose, origin, direction, max_range, min_range);
    if (other.range < hit.range) hit = other;
  }
  return hit;
}

RayHit cast_beam(const Surroundings& around, const LidarOptions& lidar, const Vector2d& origin,
                 const Vector2d& direction) {
  constexpr int kPanes = 8;
  constexpr double kBeyond_m = 1e-6;
  const double glass_cos = std::cos(deg_to_rad(lidar.glass_deg));
  double from = 0.0;
  for (int pane = 0; pane < kPanes; ++pane) {
    const RayHit hit = around.cast(origin, direction, lidar.range_max_m, from);
    if (!hit.found()) return {};
    if (hit.material == Material::kGlass && hit.cos_incidence < glass_cos) {
      from = hit.range + kBeyond_m;
      continue;
    }
    if (hit.material == Material::kBlack && hit.range > lidar.black_range * lidar.range_max_m) return {};
    return hit;
  }
  return {};
}

Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar, const Pose2& T_world_laser, Random& random) {
  LidarOptions still = lidar;
  still.motion = false;
  Scan scan = simulate_scan(
      around, still, [&](double) { return T_world_laser; }, 0.0, random);
  scan.time_increment = 0.0;
  return scan;
}

Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar,
                   const std::function<Pose2(double)>& T_world_laser, double stamp_s, Random& random) {
  const auto count = static_cast<std::size_t>(lidar.beams);
  const double first = deg_to_rad(lidar.angle_min_deg), step = lidar.angle_increment(), dt = lidar.time_increment();
  const double grazing = deg_to_rad(lidar.grazing_deg);
  std::vector<Pose2> poses(lidar.motion ? count : 1);
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = T_world_laser(static_cast<double>(i) * dt);
  const auto pose_of = [&](std::size_t i) -> const Pose2& { return poses[lidar.motion ? i : 0]; };
  const auto angle_of = [&](std::size_t i) { return pose_of(i).theta + first + static_cast<double>(i) * step; };

  std::vector<RayHit> hits(count);
  for (std::size_t i = 0; i < count; ++i)
    hits[i] = cast_beam(around, lidar, pose_of(i).translation(), unit(angle_of(i)));

  std::vector<float> raw(count, 0.0F);
  const bool closed = lidar.fov_deg >= 360.0;
  for (std::size_t i = 0; i < count; ++i) {
    // Every beam draws in the same order, so that one fault does not shift the chance of the next.
    const bool lost = random.chance(lidar.dropout);
    const double graze = random.uniform();
    if (!hits[i].found() || lost) continue;
    const double incidence = std::acos(std::clamp(hits[i].cos_incidence, 0.0, 1.0));
    if (incidence > grazing && graze < (incidence - grazing) / (0.5 * kPi - grazing)) continue;
    double range = hits[i].range;
    if (lidar.mixed_pixels > 0.0) {
      // Rims need looking at only where a neighbouring beam says something else.
      constexpr double kJump_m = 0.08;
      const auto differs = [&](std::size_t j) { return !(std::abs(hits[j].range - range) < kJump_m); };
      const bool before = i > 0 ? differs(i - 1) : closed && differs(count - 1);
      const bool after = i + 1 < count ? differs(i + 1) : closed && differs(0);
      if (before || after) range = mix_rims(around, lidar, pose_of(i), angle_of(i), range, random);
    }
    raw[i] = measured(lidar, range, random);
  }
  Scan scan = make_scan(raw, lidar.geometry());
  scan.stamp = stamp_from_seconds(stamp_s);
  scan.time_increment = dt;
  return scan;
}

}  // namespace phasescan::sim
