/// Fast ray casting in a fixed set of surfaces: a uniform grid walked cell by cell.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "sim/world.hpp"

namespace phasescan::sim {

/// Where a ray met a surface.
struct RayHit {
  double range = std::numeric_limits<double>::infinity();  ///< [m] along the ray; infinity = nothing was met
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();        ///< unit, towards the ray's origin
  double cos_incidence = 0.0;                              ///< cosine between the ray and the surface's normal, 0..1
  Material material = Material::kMatt;

  bool found() const { return range < std::numeric_limits<double>::infinity(); }
};

/// The nearest surface of a small shape along a ray, by looking at all of them: for moved objects, and as the oracle.
///
/// @param direction  unit vector
/// @return the hit with the smallest range in (min_range, max_range]
/// @cost O(n)
RayHit cast_all(const Shape& shape, const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double max_range,
                double min_range = 0.0);

/// The same in a world of thousands of surfaces. Holds its own copy of them; any number of threads may read it.
class RayCaster {
 public:
  explicit RayCaster(const Shape& shape);

  /// See cast_all. @cost about the number of grid cells along the ray.
  RayHit cast(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, double max_range,
              double min_range = 0.0) const;

  /// True where nothing opaque or transparent lies between two points.
  bool line_of_sight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Distance to the nearest surface, looked for no farther than `limit` [m]; 0 inside a solid or disc.
  double clearance(const Eigen::Vector2d& p, double limit) const;

  const Shape& shape() const { return shape_; }

 private:
  int column(double x) const;
  int row(double y) const;

  Shape shape_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double cell_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> starts_;  ///< first entry of each cell in items_
  std::vector<std::uint32_t> items_;   ///< segments first, discs after them
};

}  // namespace phasescan::sim
