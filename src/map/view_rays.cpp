#include "map/view_rays.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {

std::vector<ViewRay> view_rays(const PlacedScan& view, double* step_rad) {
  const Scan& scan = view.scan;
  const bool moving = !view.twist.is_zero() && scan.time_increment != 0.0;
  std::vector<ViewRay> rays(scan.size());
  for (std::size_t b = 0; b < scan.size(); ++b) {
    const Pose2 pose = moving ? view.T_map_laser * exp_twist(view.twist, static_cast<double>(b) * scan.time_increment)
                              : view.T_map_laser;
    const double angle = pose.theta + scan.angle(b);
    ViewRay& ray = rays[b];
    ray.from = pose.translation();
    ray.direction = {std::cos(angle), std::sin(angle)};
    if (scan.is_hit(b)) {
      ray.range = static_cast<double>(scan.ranges[b]);
      ray.end = RayEnd::kHit;
    } else if (scan.states[b] == BeamState::kNoReturn || scan.states[b] == BeamState::kOutOfRange) {
      ray.end = RayEnd::kVanished;
    }
  }
  *step_rad = rays.size() > 1 ? std::acos(std::clamp(rays[0].direction.dot(rays[1].direction), -1.0, 1.0)) : 0.0;
  return rays;
}

MapLine LineSums::line() const {
  MapLine line;
  if (n < 1.0) return line;
  line.at = {x / n, y / n};
  const double sxx = xx / n - line.at.x() * line.at.x(), syy = yy / n - line.at.y() * line.at.y(),
               sxy = xy / n - line.at.x() * line.at.y();
  const double angle = 0.5 * std::atan2(2.0 * sxy, sxx - syy);
  line.along = {std::cos(angle), std::sin(angle)};
  return line;
}

Meeting meet(const ViewRay& ray, const MapLine& line) {
  Meeting m;
  const double before = line.offset(ray.from), speed = line.normal().dot(ray.direction);
  if (std::abs(speed) < 0.02 || before * speed >= 0.0) return m;
  m.meets = true;
  m.range = -before / speed;
  m.place = line.place(ray.from + m.range * ray.direction);
  m.cosine = std::min(1.0, std::abs(speed));
  if (ray.end == RayEnd::kHit) m.behind = (ray.range - m.range) * std::abs(speed);
  return m;
}

}  // namespace phasescan
