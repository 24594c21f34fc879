#include "sim/beam_losses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim/beam_cast.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// A number in [0, 1) that belongs to the patch of surface at a place, for question `which`.
double patch_number(const Vector2d& place, double patch_m, std::uint64_t which) {
  const auto cell = [&](double x) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / patch_m)));
  };
  const std::uint64_t bits = Random::derive(Random::derive(cell(place.x()), cell(place.y())), which);
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

/// Whether a surface ends between two neighbouring hits: neither lies on the other's surface, or one is none.
bool surface_ends(const RayHit& a, double angle_a, const RayHit& b, double angle_b) {
  constexpr double kDeep_m = 0.05;
  if (!a.found() || !b.found()) return a.found() != b.found();
  const Vector2d apart = b.range * unit(angle_b) - a.range * unit(angle_a);
  return std::abs(a.normal.dot(apart)) > kDeep_m && std::abs(b.normal.dot(apart)) > kDeep_m;
}

}  // namespace

double surface_loss(const LidarOptions& lidar, const Vector2d& place, double range, double by_edge) {
  const SensorEffects& effects = lidar.effects;
  const double by_range =
      effects.dropout_ranges_m.empty() ? 0.0 : table_value(effects.dropout_ranges_m, effects.dropout_shares, range);
  double by_patch = 0.0;
  if (effects.patch_share > 0.0 && patch_number(place, effects.patch_m, 1) < effects.patch_share)
    by_patch = patch_number(place, effects.patch_m, 2);
  return 1.0 - (1.0 - by_range) * (1.0 - by_patch) * (1.0 - by_edge);
}

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

}  // namespace phasescan::sim
