#include "phasescan/odometry/map_points.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kLoneSigma = 0.03F;    // [m] of a hit without a line
constexpr float kModelSigma = 0.003F;  // [m] walls are not lines and beams are not points

}  // namespace

Twist2 LaserMount::laser_twist(const Twist2& base) const {
  const double vx = base.vx - base.omega * T_base_laser.y, vy = base.vy + base.omega * T_base_laser.x;
  const double c = std::cos(T_base_laser.theta), s = std::sin(T_base_laser.theta);
  const Twist2 upright{c * vx + s * vy, -s * vx + c * vy, base.omega};
  return flipped ? Twist2{upright.vx, -upright.vy, -upright.omega} : upright;
}

void MapPoints::clear() {
  for (auto* v : {&x, &y, &nx, &ny, &variance}) v->clear();
  with_normal = 0;
}

void to_map_points(const SurfacePoints& surface, const LaserMount& mount, double max_range_m, MapPoints& out) {
  out.clear();
  for (auto* v : {&out.x, &out.y, &out.nx, &out.ny, &out.variance}) v->reserve(surface.size());
  const auto c = static_cast<float>(std::cos(mount.T_base_laser.theta)),
             s = static_cast<float>(std::sin(mount.T_base_laser.theta));
  const auto tx = static_cast<float>(mount.T_base_laser.x), ty = static_cast<float>(mount.T_base_laser.y);
  const float side = mount.flipped ? -1.0F : 1.0F;
  const auto limit = static_cast<float>(max_range_m), spacing = static_cast<float>(surface.spacing);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const SurfacePoint& p = surface[i];
    if (surface.range[i] > limit) continue;
    const float py = side * p.y, ny = side * p.ny;
    out.x.push_back(c * p.x - s * py + tx);
    out.y.push_back(s * p.x + c * py + ty);
    out.nx.push_back(c * p.nx - s * ny);
    out.ny.push_back(s * p.nx + c * ny);
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
