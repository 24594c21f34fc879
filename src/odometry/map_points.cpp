#include "odometry/map_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "odometry/free_standing.hpp"

namespace phasescan {
namespace {

// Hits and the lines through them; sigmas as of cheap lidars.
constexpr float kLoneSigma = 0.03F;     // [m] of a hit without a line
constexpr float kGrazingCosine = 0.4F;  // between a beam and the normal of a wall that counts as grazed
constexpr float kGrazingSigmas = 8.0F;  // of the range noise: shorter than this its line is the scatter of a beam
constexpr int kGrazingBeams = 4;        // that the three hits of its line may span
constexpr float kModelSigma = 0.003F;   // [m] walls are not lines and beams are not points

/// The line of a wall seen at a grazing angle.
struct GrazingLine {
  float nx = 0, ny = 0, variance = 0, normal_variance = 0;
};

/// The line through hit `i` and two neighbours in direction, if the three lie on one that runs nearly along the beam.
std::optional<GrazingLine> grazing_line(const SurfacePoints& surface, std::size_t i) {
  const std::size_t n = surface.size();
  std::optional<GrazingLine> best;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t first = i < 2 ? 0 : i - 2; first <= i && first + 2 < n; ++first) {
    if (std::abs(surface.beam[first + 2] - surface.beam[first]) > kGrazingBeams) continue;
    const SurfacePoint &a = surface[first], &b = surface[first + 1], &c = surface[first + 2];
    const float dx = c.x - a.x, dy = c.y - a.y, length = std::sqrt(dx * dx + dy * dy);
    // The nearer end of the three sees the line least along the beam.
    const float range = std::min(surface.range[first], surface.range[first + 2]);
    if (!(length > kGrazingSigmas * surface.sigma[i]) || !(range > 0.0F)) continue;
    const float nx = -dy / length, ny = dx / length;
    const float across = nx * a.x + ny * a.y;
    const float cosine = std::fabs(across) / range;
    if (cosine > kGrazingCosine) continue;
    const float sigma = std::max(cosine, 0.1F) * surface.sigma[i] + kModelSigma;
    const float off = std::fabs(nx * (b.x - a.x) + ny * (b.y - a.y));
    if (off > 3.0F * sigma || off >= least) continue;
    least = off;
    const float side = across > 0.0F ? -1.0F : 1.0F;  // towards the sensor
    best = GrazingLine{side * nx, side * ny, sigma * sigma, 2.0F * sigma * sigma / (length * length)};
  }
  return best;
}

}  // namespace

void MapPoints::clear() {
  for (auto* v : {&x, &y, &nx, &ny, &variance, &normal_variance}) v->clear();
  free_standing.clear();
  with_normal = 0;
}

void MapPoints::reserve(std::size_t hits) {
  for (auto* v : {&x, &y, &nx, &ny, &variance, &normal_variance}) v->reserve(hits);
  free_standing.reserve(hits);
}

void MapPoints::append(const MapPoints& other, std::size_t i) {
  x.push_back(other.x[i]);
  y.push_back(other.y[i]);
  nx.push_back(other.nx[i]);
  ny.push_back(other.ny[i]);
  variance.push_back(other.variance[i]);
  normal_variance.push_back(other.normal_variance[i]);
  free_standing.push_back(other.free_standing[i]);
  if (!other.lone(i)) ++with_normal;
}

void to_map_points(const SurfacePoints& surface, const Pose2& T_base_laser, double max_range_m, MapPoints& out,
                   std::vector<int>* beams) {
  out.clear();
  if (beams) beams->clear();
  out.reserve(surface.size());
  const auto c = static_cast<float>(std::cos(T_base_laser.theta)), s = static_cast<float>(std::sin(T_base_laser.theta));
  const auto tx = static_cast<float>(T_base_laser.x), ty = static_cast<float>(T_base_laser.y);
  const auto limit = static_cast<float>(max_range_m), spacing = static_cast<float>(surface.spacing);
  std::vector<std::uint8_t> free_standing;
  mark_free_standing(surface, free_standing);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    SurfacePoint p = surface[i];
    if (surface.range[i] > limit) continue;
    float normal_variance = surface.normal_variance[i];
    if (!p.has_normal()) {
      if (const std::optional<GrazingLine> line = grazing_line(surface, i)) {
        p.nx = line->nx, p.ny = line->ny, p.variance = line->variance;
        normal_variance = line->normal_variance;
      }
    }
    out.normal_variance.push_back(normal_variance);
    out.free_standing.push_back(free_standing[i]);
    if (beams) beams->push_back(surface.beam[i]);
    out.x.push_back(c * p.x - s * p.y + tx);
    out.y.push_back(s * p.x + c * p.y + ty);
    out.nx.push_back(c * p.nx - s * p.ny);
    out.ny.push_back(s * p.nx + c * p.ny);
    if (p.has_normal()) {
      out.variance.push_back(p.variance + kModelSigma * kModelSigma);
      ++out.with_normal;
    } else {
      // A hit by itself: somewhere within its beam's share of the circle.
      const float wide = std::max(kLoneSigma, 0.5F * spacing * surface.range[i]);
      out.variance.push_back(wide * wide);
    }
  }
}

}  // namespace phasescan
