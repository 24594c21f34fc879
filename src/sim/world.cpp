#include "sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan::sim {

void Shape::add_line(const Polygon& points, Material material) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) segments.push_back({points[i], points[i + 1], material});
}

void Shape::add_solid(const Polygon& outline, Material material) {
  add_line(outline, material);
  segments.push_back({outline.back(), outline.front(), material});
  solids.push_back(outline);
}

void Shape::add_box(const Eigen::Vector2d& center, double width, double depth, Material material) {
  const double w = 0.5 * width, d = 0.5 * depth, x = center.x(), y = center.y();
  add_solid({{x - w, y - d}, {x + w, y - d}, {x + w, y + d}, {x - w, y + d}}, material);
}

void Shape::add_disc(const Eigen::Vector2d& center, double radius, Material material) {
  discs.push_back({center, radius, material});
}

void Shape::append(const Shape& other, const Pose2& T_this_other) {
  for (const Segment& s : other.segments) segments.push_back({T_this_other * s.a, T_this_other * s.b, s.material});
  for (const Disc& d : other.discs) discs.push_back({T_this_other * d.center, d.radius, d.material});
  for (const Polygon& solid : other.solids) {
    Polygon moved;
    for (const auto& p : solid) moved.push_back(T_this_other * p);
    solids.push_back(std::move(moved));
  }
}

double Shape::clearance(const Eigen::Vector2d& p) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Segment& s : segments) nearest = std::min(nearest, point_segment_distance(p, s.a, s.b));
  for (const Disc& d : discs) nearest = std::min(nearest, std::max(0.0, (p - d.center).norm() - d.radius));
  for (const Polygon& solid : solids) {
    if (inside_polygon(solid, p)) return 0.0;
  }
  return nearest;
}

bool inside_polygon(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const auto &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

double point_segment_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - (a + t * ab)).norm();
}

}  // namespace phasescan::sim
