/// A small map of surface elements around one place, made of a few scans: what a scan is matched against.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "odometry/map_points.hpp"
#include "odometry/free_standing.hpp"
#include "odometry/surfel_table.hpp"
#include "refine/nearest_grid.hpp"

namespace phasescan {

/// A piece of surface: the mean of the points that fell into one cell with much the same normal.
struct Surfel {
  float x = 0.0F, y = 0.0F;        ///< [m] in the map's own frame
  float nx = 0.0F, ny = 0.0F;      ///< unit normal, (0, 0) for lone hits
  float variance = 0.0F;           ///< across the surface [m^2]
  float normal_variance = 0.0F;    ///< of the normal's direction [rad^2]
  std::int32_t next = -1;          ///< next surfel of the same cell, in a ring
  std::uint8_t free_standing = 0;  ///< 1: of a static object that stands free
};

/// Surfels and the grid that finds them. Build: reset, add scans, finish. Bounded by its window, whatever is added.
class LocalMap {
 public:
  /// Empties the map. Its frame is placed at `T_world_map`; scans are then added with world poses.
  /// @param half_width_m  of the window; points outside are left out
  /// @param cell_m        size of a cell; partners are found up to 3 cells away
  void reset(const Pose2& T_world_map, double half_width_m, double cell_m);
  /// Free-standing objects become part of the map once two of its scans show that they are static.
  void add(const MapPoints& points, const Pose2& T_world_base);
  /// Merges the points into surfels and builds the grid. @cost O(points + window / 16)
  void finish();

  const Pose2& T_world_map() const { return T_world_map_; }
  const std::vector<Surfel>& surfels() const { return surfels_; }
  bool empty() const { return surfels_.empty(); }
  double reach_m() const { return 3.0 * cell_m_; }

  /// The surfel that a point with that normal belongs to, or null: near, and facing the same way (normals within
  /// acos(min_cosine)).
  const Surfel* find(float px, float py, float nx, float ny, float min_cosine) const {
    const int first = grid_.nearest(px, py);
    if (first < 0) return nullptr;
    const Surfel* best = nullptr;
    float best_cosine = min_cosine;
    int at = first;
    do {
      const Surfel& s = surfels_[static_cast<std::size_t>(at)];
      const float cosine = s.nx * nx + s.ny * ny;
      if (cosine > best_cosine) best_cosine = cosine, best = &s;
      at = s.next;
    } while (at != first);
    return best;
  }

  /// Whether what is nearest to a point is a static object that stands free.
  bool free_standing_at(float px, float py) const {
    const int any = grid_.nearest(px, py), alone = lone_grid_.nearest(px, py);
    return (any >= 0 && surfels_[static_cast<std::size_t>(any)].free_standing) ||
           (alone >= 0 && lone_[static_cast<std::size_t>(alone)].free_standing);
  }

  /// The lone hits' surfel nearest to a point, or null.
  const Surfel* find_lone(float px, float py) const {
    const int at = lone_grid_.nearest(px, py);
    return at < 0 ? nullptr : &lone_[static_cast<std::size_t>(at)];
  }

 private:
  /// Hits that stand free, and what finish() needs to tell which of them are static.
  struct FreeStanding {
    struct Surface {
      float nx, ny, variance, normal_variance;
    };
    std::vector<FreeStandingHit> hits;
    std::vector<Surface> surfaces;  ///< one per hit
    std::vector<Pose2> views;       ///< T_map_base of each scan
    StaticObjectFilter filter;
    std::vector<std::uint8_t> is_static;
  };
  void normalise(std::vector<Surfel>& surfels, NearestGrid& grid);
  void add_point(float px, float py, float nx, float ny, float variance, float normal_variance,
                 std::uint8_t free_standing);
  void add_lone(std::uint64_t cell, float px, float py, float weight, std::uint8_t free_standing);
  void add_static_objects();

  Pose2 T_world_map_;
  double cell_m_ = 0.1, half_width_m_ = 20.0;
  float inverse_cell_ = 10.0F, extent_m_ = 0.0F;
  std::vector<Surfel> surfels_;  // x, y, nx, ny hold weighted sums until finish(), variance the sum of weights
  std::vector<Surfel> lone_;
  SurfelTable table_;
  FreeStanding free_standing_;
  std::vector<SurfacePoint> grid_points_;  // where the surfels are, as the grid wants it
  NearestGrid grid_, lone_grid_;
};

}  // namespace phasescan
