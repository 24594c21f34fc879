#include "sim/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/revolution.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

Vector2d unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// What one beam looks along: an azimuth in the world and, where the sensor is tilted, how its range differs from that
/// of its shadow on the floor.
struct BeamRay {
  Vector2d direction;
  double shadow = 1.0;                                     ///< length of the shadow of 1 m of beam
  double floor = std::numeric_limits<double>::infinity();  ///< range at which it meets the floor [m]
};

/// @param angle  of the beam in the world; with a tilt, in the sensor's plane
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

/// What answers along a ray; its range is that of the beam itself.
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

/// A mixed pixel: where the two rims of a beam meet surfaces at different ranges the sensor says one, or something
/// between.
double mix_rims(const Surroundings& around, const LidarOptions& lidar, const Pose2& pose, double angle, double range,
                Random& random) {
  constexpr double kEdge_m = 0.08;
  const double half = 0.5 * deg_to_rad(lidar.beam_width_deg);
  const RayHit left = cast_ray(around, lidar, pose, beam_ray(lidar, pose, angle + half));
  const RayHit right = cast_ray(around, lidar, pose, beam_ray(lidar, pose, angle - half));
  if (!left.found() || !right.found() || std::abs(left.range - right.range) < kEdge_m) return range;
  if (!random.chance(lidar.mixed_pixels)) return range;
  return left.range + (right.range - left.range) * random.uniform();
}

/// A number in [0, 1) that belongs to the patch of surface at a place, for question `which`.
double patch_number(const Vector2d& place, double patch_m, std::uint64_t which) {
  const auto cell = [&](double x) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / patch_m)));
  };
  const std::uint64_t bits = Random::derive(Random::derive(cell(place.x()), cell(place.y())), which);
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

/// Share of beams lost on a surface besides those lost everywhere.
/// @param by_edge  share lost as an edge is near
double surface_loss(const LidarOptions& lidar, const Vector2d& place, double range, double by_edge) {
  const SensorEffects& effects = lidar.effects;
  const double by_range =
      effects.dropout_ranges_m.empty() ? 0.0 : table_value(effects.dropout_ranges_m, effects.dropout_shares, range);
  double by_patch = 0.0;
  if (effects.patch_share > 0.0 && patch_number(place, effects.patch_m, 1) < effects.patch_share)
    by_patch = patch_number(place, effects.patch_m, 2);
  return 1.0 - (1.0 - by_range) * (1.0 - by_patch) * (1.0 - by_edge);
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
  Random copy = random;  // looking at it leaves the draws of `random` as they are
  RevolutionSource source(lidar, copy.bits());
  return simulate_scan(around, lidar, source, 1.0 / lidar.rate_hz, T_world_laser, stamp_s, random);
}

namespace {

/// The geometry of one scan: where each beam starts and what it looks along.
struct Beams {
  std::vector<Pose2> poses;    ///< one, or one a beam
  std::vector<double> angles;  ///< in the world; with a tilt, in the sensor's plane
  std::vector<RayHit> hits;
  std::vector<bool> sampled;  ///< empty: all

  const Pose2& pose(std::size_t i) const { return poses[poses.size() > 1 ? i : 0]; }
};

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

/// Whether a surface ends between two neighbouring hits: neither lies on the other's surface, or one is none.
bool surface_ends(const RayHit& a, double angle_a, const RayHit& b, double angle_b) {
  constexpr double kDeep_m = 0.05;
  if (!a.found() || !b.found()) return a.found() != b.found();
  const Vector2d apart = b.range * unit(angle_b) - a.range * unit(angle_a);
  return std::abs(a.normal.dot(apart)) > kDeep_m && std::abs(b.normal.dot(apart)) > kDeep_m;
}

/// Share of each beam's answers that are lost as an edge is near; empty where the sensor loses none.
std::vector<double> edge_losses(const Beams& beams, const LidarOptions& lidar) {
  const SensorEffects& effects = lidar.effects;
  if (effects.edge_loss <= 0.0) return {};
  const std::size_t n = beams.hits.size();
  std::vector<std::size_t> asked;
  for (std::size_t i = 0; i < n; ++i) {
    if (beams.sampled.empty() || beams.sampled[i]) asked.push_back(i);
  }
  std::vector<double> losses(n, 0.0);
  const double step_deg = std::abs(rad_to_deg(lidar.angle_increment()));
  const auto reach = static_cast<std::ptrdiff_t>(effects.edge_width_deg / step_deg + 1.0);
  const bool closed = lidar.fov_deg >= 360.0;
  for (std::size_t k = 0; k + (closed ? 0 : 1) < asked.size(); ++k) {
    const std::size_t i = asked[k], j = asked[(k + 1) % asked.size()];
    if (!surface_ends(beams.hits[i], beams.angles[i], beams.hits[j], beams.angles[j])) continue;
    const auto size = static_cast<std::ptrdiff_t>(n), first = static_cast<std::ptrdiff_t>(i);
    const double edge = 0.5 * static_cast<double>(j > i ? j - i : j + n - i);
    for (std::ptrdiff_t d = -reach; d <= reach + 1; ++d) {
      if (!closed && (first + d < 0 || first + d >= size)) continue;
      const double off_deg = std::abs(static_cast<double>(d) - edge) * step_deg;
      double& loss = losses[static_cast<std::size_t>((first + d + 2 * size) % size)];
      loss = std::max(loss, effects.edge_loss * std::max(0.0, 1.0 - off_deg / effects.edge_width_deg));
    }
  }
  return losses;
}

/// Stated directions where the sensor rounds them; empty where the geometry says them.
std::vector<float> stated_angles(const LidarOptions& lidar) {
  std::vector<float> angles;
  const double grain = deg_to_rad(lidar.effects.bearing_step_deg);
  if (grain <= 0.0) return angles;
  for (int i = 0; i < lidar.beams; ++i) {
    const double angle = deg_to_rad(lidar.angle_min_deg) + i * lidar.angle_increment();
    angles.push_back(static_cast<float>(std::round(angle / grain) * grain));
  }
  return angles;
}

}  // namespace

Scan simulate_scan(const Surroundings& around, const LidarOptions& lidar, RevolutionSource& source, double period_s,
                   const std::function<Pose2(double)>& T_world_laser, double stamp_s, Random& random) {
  const auto count = static_cast<std::size_t>(lidar.beams);
  const double dt =
      lidar.effects.rate_wander > 0.0 ? lidar.time_increment() * period_s * lidar.rate_hz : lidar.time_increment();
  const double grazing = deg_to_rad(lidar.grazing_deg);
  const Revolution revolution = source.next(period_s);
  const Beams beams = cast_beams(around, lidar, revolution, dt, T_world_laser);
  const std::vector<RayHit>& hits = beams.hits;

  // Where beams look elsewhere than stated, other beams hit and draw: then each beam has a stream of its own, so that
  // one effect does not shift the noise of the beams behind it. Else one stream for all, as old sensor files have it.
  const bool own_streams = lidar.effects.moves_beams();
  const std::uint64_t base = own_streams ? random.bits() : 0;
  const std::vector<double> edges = edge_losses(beams, lidar);
  std::vector<float> raw(count, 0.0F);
  const bool closed = lidar.fov_deg >= 360.0;
  for (std::size_t i = 0; i < count; ++i) {
    Random own(Random::derive(base, i));
    Random& chance = own_streams ? own : random;
    // Every beam draws in the same order, so that one fault does not shift the chance of the next.
    const bool lost = chance.chance(lidar.dropout);
    const double graze = chance.uniform();
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
      if (before || after) range = mix_rims(around, lidar, beams.pose(i), beams.angles[i], range, chance);
    }
    raw[i] = measured(lidar, range, chance);
    if (revolution.luck.empty()) continue;
    const Vector2d place = beams.pose(i).translation() + hits[i].range * unit(beams.angles[i]);
    const double by_edge = edges.empty() ? 0.0 : edges[i];
    if (revolution.luck[i] < surface_loss(lidar, place, hits[i].range, by_edge)) raw[i] = 0.0F;
  }
  source.lose_sector(revolution, raw);
  Scan scan = make_scan(raw, lidar.geometry(), stated_angles(lidar));
  scan.stamp = stamp_from_seconds(stamp_s);
  scan.time_increment = dt;
  return scan;
}

}  // namespace phasescan::sim
