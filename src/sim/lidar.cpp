#include "sim/lidar.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::sim {

using Eigen::Vector2d;

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
  const Table &at = effects.noise_ranges_m, &sigmas = effects.noise_sigmas_m;
  if (!at.empty()) return range > at.back() ? sigmas.back() * range / at.back() : table_value(at, sigmas, range);
  return std::max(sigma_m, sigma_relative * range);
}

double LidarOptions::bearing_sigma() const {
  // Directions that are off by no more than half a step, all alike, have step^2 / 12 as their variance.
  const double sampled = effects.sample_rate_hz > 0.0 ? angle_increment() : 0.0;
  const double jitter = deg_to_rad(effects.direction_jitter_deg), rounded = deg_to_rad(effects.bearing_step_deg);
  return std::sqrt(jitter * jitter + (sampled * sampled + rounded * rounded) / 12.0);
}

LidarOptions LidarOptions::noise_free() const {
  LidarOptions clean = *this;
  clean.sigma_m = clean.sigma_relative = clean.resolution_m = clean.dropout = clean.mixed_pixels = 0.0;
  clean.grazing_deg = 90.0;
  clean.effects = {};
  return clean;
}

void check_lidar(std::string_view section, const LidarOptions& lidar) {
  validate_options(section, lidar);
  check_effects(section, lidar.effects);
}

double dropout_share(const LidarOptions& lidar, double range) {
  const SensorEffects& effects = lidar.effects;
  const double by_range =
      effects.dropout_ranges_m.empty() ? 0.0 : table_value(effects.dropout_ranges_m, effects.dropout_shares, range);
  return 1.0 - (1.0 - lidar.dropout) * (1.0 - by_range);
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

double revolution_turn_sigma(const LidarOptions& lidar) {
  const double turn = deg_to_rad(lidar.effects.revolution_turn_deg);
  double together = 0.0;  // half a beam, uniform, where all samples of a turn are said beside by the same
  if (lidar.effects.sample_rate_hz > 0.0) {
    const double step = std::abs(lidar.angle_increment());
    // Over a turn samples run away from beams by this many beams; each whole one averages the offset out.
    const double run_away = std::abs(lidar.effects.sample_rate_hz / lidar.rate_hz - kTwoPi / step);
    together = step / std::sqrt(12.0) / std::max(1.0, run_away);
  }
  return std::hypot(turn, together);
}

}  // namespace phasescan::sim
