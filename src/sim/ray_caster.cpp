#include "sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

void meet(const Segment& s, const Vector2d& origin, const Vector2d& direction, double max_range, double min_range,
          RayHit& best) {
  const Vector2d edge = s.b - s.a;
  const double det = cross(direction, edge);
  if (det == 0.0) return;
  const Vector2d to = s.a - origin;
  const double t = cross(to, edge) / det;
  if (!(t > min_range && t <= max_range && t < best.range)) return;
  const double u = cross(to, direction) / det;
  if (u < 0.0 || u > 1.0) return;
  Vector2d normal = Vector2d(-edge.y(), edge.x()).normalized();
  if (normal.dot(direction) > 0.0) normal = -normal;
  best = {t, normal, -normal.dot(direction), s.material};
}

void meet(const Disc& d, const Vector2d& origin, const Vector2d& direction, double max_range, double min_range,
          RayHit& best) {
  const Vector2d to = d.center - origin;
  const double along = to.dot(direction);
  const double half2 = d.radius * d.radius - (to.squaredNorm() - along * along);
  if (half2 <= 0.0) return;
  const double half = std::sqrt(half2);
  // The near side, or the far side for a ray that starts inside.
  double t = along - half;
  if (!(t > min_range)) t = along + half;
  if (!(t > min_range && t <= max_range && t < best.range)) return;
  Vector2d normal = (origin + t * direction - d.center).normalized();
  if (normal.dot(direction) > 0.0) normal = -normal;
  best = {t, normal, -normal.dot(direction), d.material};
}

}  // namespace

RayHit cast_all(const Shape& shape, const Vector2d& origin, const Vector2d& direction, double max_range,
                double min_range) {
  RayHit best;
  for (const Segment& s : shape.segments) meet(s, origin, direction, max_range, min_range, best);
  for (const Disc& d : shape.discs) meet(d, origin, direction, max_range, min_range, best);
  return best;
}

RayCaster::RayCaster(const Shape& shape) : shape_(shape) {
  const std::size_t count = shape_.segments.size() + shape_.discs.size();
  if (count == 0) return;
  const auto box_of = [&](std::size_t i, Vector2d& low, Vector2d& high) {
    if (i < shape_.segments.size()) {
      low = shape_.segments[i].a.cwiseMin(shape_.segments[i].b);
      high = shape_.segments[i].a.cwiseMax(shape_.segments[i].b);
    } else {
      const Disc& d = shape_.discs[i - shape_.segments.size()];
      low = d.center.array() - d.radius;
      high = d.center.array() + d.radius;
    }
  };
  Vector2d low = Vector2d::Constant(1e300), high = Vector2d::Constant(-1e300);
  for (std::size_t i = 0; i < count; ++i) {
    Vector2d a, b;
    box_of(i, a, b);
    low = low.cwiseMin(a);
    high = high.cwiseMax(b);
  }
  constexpr double kMargin = 1e-3;
  origin_ = low.array() - kMargin;
  const Vector2d size = (high - low).array() + 2.0 * kMargin;
  // About two cells per surface, none smaller than 0.2 m, and never more than a thousand a side.
  cell_ =
      std::max({0.2, std::sqrt(size.x() * size.y() / (2.0 * static_cast<double>(count))), size.maxCoeff() / 1000.0});
  columns_ = static_cast<int>(size.x() / cell_) + 1;
  rows_ = static_cast<int>(size.y() / cell_) + 1;

  // A segment enters the cells of its bounding box that it really crosses: those whose corners lie on both sides of its
  // line.
  const auto for_cells = [&](std::size_t i, auto&& visit) {
    Vector2d a, b;
    box_of(i, a, b);
    for (int r = row(a.y() - kMargin); r <= row(b.y() + kMargin); ++r) {
      for (int c = column(a.x() - kMargin); c <= column(b.x() + kMargin); ++c) {
        if (i < shape_.segments.size()) {
          const Segment& s = shape_.segments[i];
          const Vector2d edge = s.b - s.a;
          const Vector2d middle = origin_ + Vector2d(c + 0.5, r + 0.5) * cell_;
          const double reach = (0.5 * cell_ + kMargin) * (std::abs(edge.x()) + std::abs(edge.y()));
          if (std::abs(cross(edge, middle - s.a)) > reach) continue;
        }
        visit(static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c));
      }
    }
  };
  starts_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (std::size_t i = 0; i < count; ++i) for_cells(i, [&](std::size_t cell) { ++starts_[cell + 1]; });
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  items_.resize(starts_.back());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < count; ++i) {
    for_cells(i, [&](std::size_t cell) { items_[next[cell]++] = static_cast<std::uint32_t>(i); });
  }
}

int RayCaster::column(double x) const {
  return std::clamp(static_cast<int>(std::floor((x - origin_.x()) / cell_)), 0, columns_ - 1);
}
int RayCaster::row(double y) const {
  return std::clamp(static_cast<int>(std::floor((y - origin_.y()) / cell_)), 0, rows_ - 1);
}

RayHit RayCaster::cast(const Vector2d& origin, const Vector2d& direction, double max_range, double min_range) const {
  RayHit best;
  if (items_.empty()) return best;
  // The part of the ray inside the grid.
  double t = min_range, t_end = max_range;
  const Vector2d size(columns_ * cell_, rows_ * cell_);
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < origin_[axis] || origin[axis] > origin_[axis] + size[axis]) return best;
      continue;
    }
    double enter = (origin_[axis] - origin[axis]) / direction[axis];
    double leave = (origin_[axis] + size[axis] - origin[axis]) / direction[axis];
    if (enter > leave) std::swap(enter, leave);
    t = std::max(t, enter);
    t_end = std::min(t_end, leave);
  }
  if (t > t_end) return best;

  const Vector2d start = origin + t * direction;
  int c = column(start.x()), r = row(start.y());
  const int step_c = direction.x() > 0.0 ? 1 : -1, step_r = direction.y() > 0.0 ? 1 : -1;
  const auto border = [&](int axis, int index, int step) {
    if (direction[axis] == 0.0) return std::numeric_limits<double>::infinity();
    return (origin_[axis] + (index + (step > 0 ? 1 : 0)) * cell_ - origin[axis]) / direction[axis];
  };
  while (c >= 0 && c < columns_ && r >= 0 && r < rows_) {
    const std::size_t cell =
        static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
    for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
      const std::size_t item = items_[i];
      if (item < shape_.segments.size()) {
        meet(shape_.segments[item], origin, direction, max_range, min_range, best);
      } else {
        meet(shape_.discs[item - shape_.segments.size()], origin, direction, max_range, min_range, best);
      }
    }
    const double next_c = border(0, c, step_c), next_r = border(1, r, step_r);
    const double leave = std::min(next_c, next_r);
    if (best.range <= leave || leave > t_end) break;
    (next_c <= next_r ? c += step_c : r += step_r);
  }
  return best;
}

bool RayCaster::line_of_sight(const Vector2d& from, const Vector2d& to) const {
  const double distance = (to - from).norm();
  return distance == 0.0 || !cast(from, (to - from) / distance, distance).found();
}

double RayCaster::clearance(const Vector2d& p, double limit) const {
  if (items_.empty()) return limit;
  for (const Polygon& solid : shape_.solids) {
    if (inside_polygon(solid, p)) return 0.0;
  }
  double nearest = limit;
  for (int r = row(p.y() - limit); r <= row(p.y() + limit); ++r) {
    for (int c = column(p.x() - limit); c <= column(p.x() + limit); ++c) {
      const std::size_t cell =
          static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
      for (std::uint32_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
        const std::size_t item = items_[i];
        if (item < shape_.segments.size()) {
          nearest = std::min(nearest, point_segment_distance(p, shape_.segments[item].a, shape_.segments[item].b));
        } else {
          const Disc& d = shape_.discs[item - shape_.segments.size()];
          nearest = std::min(nearest, std::max(0.0, (p - d.center).norm() - d.radius));
        }
      }
    }
  }
  return nearest;
}

}  // namespace phasescan::sim
