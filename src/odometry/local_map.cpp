#include "odometry/local_map.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kFloorVariance = 0.003F * 0.003F;      // [m^2] averaging does not beat the model below this
constexpr float kFloorNormalVariance = 0.03F * 0.03F;  // [rad^2] walls are not as straight as lines
constexpr int kDirections = 8;

int direction_of(float nx, float ny) {
  // Octant by comparisons: which half planes the normal lies in.
  return (nx >= 0.0F ? 0 : 1) | (ny >= 0.0F ? 0 : 2) | (std::fabs(nx) >= std::fabs(ny) ? 0 : 4);
}

/// Where a coordinate lies in cells, as std::floor but without a call.
std::int64_t cell_at(float cells) {
  const auto whole = static_cast<std::int64_t>(cells);
  return whole - (cells < static_cast<float>(whole) ? 1 : 0);
}

}  // namespace

void LocalMap::reset(const Pose2& T_world_map, double half_width_m, double cell_m) {
  T_world_map_ = T_world_map;
  half_width_m_ = half_width_m;
  cell_m_ = cell_m;
  inverse_cell_ = static_cast<float>(1.0 / cell_m);
  extent_m_ = 0.0F;
  surfels_.clear();
  lone_.clear();
  free_standing_.hits.clear();
  free_standing_.surfaces.clear();
  free_standing_.views.clear();
  table_.clear();
}

void LocalMap::add(const MapPoints& points, const Pose2& T_world_base) {
  const Pose2 T = T_world_map_.inverse() * T_world_base;
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y), limit = static_cast<float>(half_width_m_);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float px = c * points.x[i] - s * points.y[i] + tx, py = s * points.x[i] + c * points.y[i] + ty;
    if (!(std::fabs(px) < limit && std::fabs(py) < limit)) continue;
    const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
    if (points.free_standing[i]) {
      free_standing_.hits.push_back({px, py, points.x[i], points.y[i], static_cast<int>(free_standing_.views.size())});
      free_standing_.surfaces.push_back({nx, ny, points.variance[i], points.normal_variance[i]});
    } else {
      add_point(px, py, nx, ny, points.variance[i], points.normal_variance[i], 0);
    }
  }
  free_standing_.views.push_back(T);
}

void LocalMap::add_static_objects() {
  FreeStanding& f = free_standing_;
  f.filter.find(f.hits, f.views, f.is_static);
  for (std::size_t i = 0; i < f.hits.size(); ++i) {
    const FreeStanding::Surface& s = f.surfaces[i];
    if (f.is_static[i]) add_point(f.hits[i].x, f.hits[i].y, s.nx, s.ny, s.variance, s.normal_variance, 1);
  }
}

void LocalMap::add_lone(std::uint64_t cell, float px, float py, float weight, std::uint8_t free_standing) {
  std::int32_t& alone = table_.at(cell + kDirections + 1);
  if (alone < 0) {
    alone = static_cast<std::int32_t>(lone_.size());
    lone_.push_back({});
  }
  Surfel& s = lone_[static_cast<std::size_t>(alone)];
  s.x += weight * px, s.y += weight * py, s.variance += weight;
  s.free_standing |= free_standing;
  table_.reserve(surfels_.size() + lone_.size());
}

void LocalMap::add_point(float px, float py, float nx, float ny, float variance, float normal_variance,
                         std::uint8_t free_standing) {
  const auto u = static_cast<std::uint64_t>(cell_at(px * inverse_cell_) + (1 << 20));
  const auto v = static_cast<std::uint64_t>(cell_at(py * inverse_cell_) + (1 << 20));
  const std::uint64_t cell = (u << 21 | v) * (kDirections + 2);
  extent_m_ = std::max({extent_m_, std::fabs(px), std::fabs(py)});
  const float weight = 1.0F / variance;
  if (nx == 0.0F && ny == 0.0F) {
    add_lone(cell, px, py, weight, free_standing);
    return;
  }
  const std::uint64_t key = cell + 1 + static_cast<std::uint64_t>(direction_of(nx, ny));
  const auto next = static_cast<std::int32_t>(surfels_.size());
  std::int32_t mine = table_.last(key);
  if (mine < 0) {
    std::int32_t& known = table_.at(key);
    mine = known;
    if (known < 0) known = next;
    table_.remember(key, known);
  }
  if (mine >= 0) {
    Surfel& s = surfels_[static_cast<std::size_t>(mine)];
    s.x += weight * px, s.y += weight * py, s.nx += weight * nx, s.ny += weight * ny, s.variance += weight;
    s.normal_variance += weight * weight * normal_variance;
    return;
  }
  surfels_.push_back({weight * px, weight * py, weight * nx, weight * ny, weight, weight * weight * normal_variance,
                      next, free_standing});
  // Join the ring of the cell.
  std::int32_t& first = table_.at(cell);
  if (first < 0) {
    first = next;
  } else {
    Surfel& head = surfels_[static_cast<std::size_t>(first)];
    surfels_.back().next = head.next;
    head.next = next;
  }
  table_.reserve(surfels_.size() + lone_.size());
}

void LocalMap::finish() {
  add_static_objects();
  normalise(surfels_, grid_);
  normalise(lone_, lone_grid_);
}

void LocalMap::normalise(std::vector<Surfel>& surfels, NearestGrid& grid) {
  grid_points_.resize(surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    Surfel& s = surfels[i];
    const float inverse = 1.0F / s.variance;
    s.x *= inverse, s.y *= inverse;
    const float length = std::sqrt(s.nx * s.nx + s.ny * s.ny);
    if (length > 0.0F) s.nx /= length, s.ny /= length;
    s.variance = std::max(inverse, kFloorVariance);
    s.normal_variance = inverse * inverse * s.normal_variance + kFloorNormalVariance;
    grid_points_[i].x = s.x;
    grid_points_[i].y = s.y;
  }
  const double half = std::min(half_width_m_, static_cast<double>(extent_m_) + reach_m());
  grid.build(grid_points_, static_cast<float>(std::max(half, 1.0)), static_cast<float>(cell_m_));
}

}  // namespace phasescan
