#include "odometry/local_map.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kFloorVariance = 0.003F * 0.003F;      // [m^2] averaging does not beat the model below this
constexpr float kFloorNormalVariance = 0.03F * 0.03F;  // [rad^2] walls are not as straight as lines
constexpr int kDirections = 8;
constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

int direction_of(float nx, float ny) {
  // Octant by comparisons: which half planes the normal lies in.
  return (nx >= 0.0F ? 0 : 1) | (ny >= 0.0F ? 0 : 2) | (std::fabs(nx) >= std::fabs(ny) ? 0 : 4);
}

/// Where a coordinate lies in cells, as std::floor but without a call.
std::int64_t cell_of(float cells) {
  const auto whole = static_cast<std::int64_t>(cells);
  return whole - (cells < static_cast<float>(whole) ? 1 : 0);
}

std::uint64_t hash(std::uint64_t key) {
  key ^= key >> 31;
  key *= 0x9E3779B97F4A7C15ULL;
  return key ^ (key >> 29);
}

}  // namespace

void LocalMap::reset(const Pose2& T_world_map, double half_width_m, double cell_m) {
  T_world_map_ = T_world_map;
  half_width_m_ = half_width_m;
  cell_m_ = cell_m;
  inverse_cell_ = static_cast<float>(1.0 / cell_m);
  extent_m_ = 0.0F;
  last_surfel_ = -1;
  surfels_.clear();
  lone_.clear();
  free_standing_.clear();
  free_standing_surface_.clear();
  views_.clear();
  if (table_.empty()) table_.resize(4096);
  std::fill(table_.begin(), table_.end(), Slot{kEmpty, -1});
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
      free_standing_.push_back({px, py, points.x[i], points.y[i], static_cast<int>(views_.size())});
      free_standing_surface_.push_back({nx, ny, points.variance[i], points.normal_variance[i]});
    } else {
      add_point(px, py, nx, ny, points.variance[i], points.normal_variance[i], 0);
    }
  }
  views_.push_back(T);
}

void LocalMap::add_static_objects() {
  filter_.find(free_standing_, views_, static_);
  for (std::size_t i = 0; i < free_standing_.size(); ++i) {
    const FreeStandingSurface& s = free_standing_surface_[i];
    if (static_[i]) add_point(free_standing_[i].x, free_standing_[i].y, s.nx, s.ny, s.variance, s.normal_variance, 1);
  }
}

void LocalMap::add_point(float px, float py, float nx, float ny, float variance, float normal_variance,
                         std::uint8_t free_standing) {
  const auto u = static_cast<std::uint64_t>(cell_of(px * inverse_cell_) + (1 << 20));
  const auto v = static_cast<std::uint64_t>(cell_of(py * inverse_cell_) + (1 << 20));
  const std::uint64_t cell = (u << 21 | v) * (kDirections + 2);
  extent_m_ = std::max({extent_m_, std::fabs(px), std::fabs(py)});
  const float weight = 1.0F / variance;
  if (nx == 0.0F && ny == 0.0F) {
    std::int32_t& alone = slot(cell + kDirections + 1);
    if (alone < 0) {
      alone = static_cast<std::int32_t>(lone_.size());
      lone_.push_back({});
    }
    Surfel& s = lone_[static_cast<std::size_t>(alone)];
    s.x += weight * px, s.y += weight * py, s.variance += weight;
    s.free_standing |= free_standing;
    if (4 * (surfels_.size() + lone_.size()) > table_.size()) grow_table();
    return;
  }
  const std::uint64_t key = cell + 1 + static_cast<std::uint64_t>(direction_of(nx, ny));
  if (last_surfel_ < 0 || key != last_key_) {
    std::int32_t& mine = slot(key);
    last_key_ = key;
    last_surfel_ = mine;
    if (mine < 0) mine = static_cast<std::int32_t>(surfels_.size());
  }
  if (last_surfel_ >= 0) {
    Surfel& s = surfels_[static_cast<std::size_t>(last_surfel_)];
    s.x += weight * px, s.y += weight * py, s.nx += weight * nx, s.ny += weight * ny, s.variance += weight;
    s.normal_variance += weight * weight * normal_variance;
    return;
  }
  const auto index = static_cast<std::int32_t>(surfels_.size());
  last_surfel_ = index;
  surfels_.push_back({weight * px, weight * py, weight * nx, weight * ny, weight, weight * weight * normal_variance,
                      index, free_standing});
  // Join the ring of the cell.
  std::int32_t& first = slot(cell);
  if (first < 0) {
    first = index;
  } else {
    Surfel& head = surfels_[static_cast<std::size_t>(first)];
    surfels_.back().next = head.next;
    head.next = index;
  }
  if (4 * (surfels_.size() + lone_.size()) > table_.size()) grow_table();
}

std::int32_t& LocalMap::slot(std::uint64_t key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t at = hash(key) & mask;
  while (table_[at].key != kEmpty && table_[at].key != key) at = (at + 1) & mask;
  table_[at].key = key;
  return table_[at].surfel;
}

void LocalMap::grow_table() {
  std::vector<Slot> old(2 * table_.size(), Slot{kEmpty, -1});
  old.swap(table_);
  for (const Slot& s : old) {
    if (s.key != kEmpty) slot(s.key) = s.surfel;
  }
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
