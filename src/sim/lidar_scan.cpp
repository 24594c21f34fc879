// Scans of a simulated lidar.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/beam_cast.hpp"
#include "sim/beam_losses.hpp"
#include "sim/lidar.hpp"
#include "sim/revolution.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

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

/// What the sensor says to a true range; 0 = nothing.
float measured(const LidarOptions& lidar, double range, Random& random) {
  double value = random.normal(range, lidar.sigma(range));
  if (lidar.resolution_m > 0.0) value = std::round(value / lidar.resolution_m) * lidar.resolution_m;
  return value >= lidar.range_min_m && value <= lidar.range_max_m ? static_cast<float>(value) : 0.0F;
}

}  // namespace

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
