// The beams of a placed scan as rays on the map.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "map/glass.hpp"

namespace phasescan {

enum class RayEnd : std::uint8_t { kHit, kVanished, kUnknown };

struct ViewRay {
  Eigen::Vector2d from, direction;
  double range = 0.0;  ///< 0 without a hit
  RayEnd end = RayEnd::kUnknown;
  Eigen::Vector2d point() const { return from + range * direction; }
};

/// In the order of the beams. `step_rad`: angle between two of them.
std::vector<ViewRay> view_rays(const PlacedScan& view, double* step_rad);

/// A line: a point on it and its unit direction.
struct MapLine {
  Eigen::Vector2d at = Eigen::Vector2d::Zero(), along = Eigen::Vector2d::UnitX();
  Eigen::Vector2d normal() const { return {-along.y(), along.x()}; }
  double offset(const Eigen::Vector2d& p) const { return normal().dot(p - at); }
  double place(const Eigen::Vector2d& p) const { return along.dot(p - at); }
};

/// Sums of points: a line can be fitted to them at any time.
struct LineSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(const Eigen::Vector2d& p) {
    n += 1, x += p.x(), y += p.y(), xx += p.x() * p.x(), xy += p.x() * p.y(), yy += p.y() * p.y();
  }
  void add(const LineSums& o) { n += o.n, x += o.x, y += o.y, xx += o.xx, xy += o.xy, yy += o.yy; }
  MapLine line() const;
};

/// A hit so far behind a line went through it [m].
inline constexpr double kThroughM = 0.25;

/// How a ray meets a line.
struct Meeting {
  bool meets = false;
  double range = 0.0;   ///< to the line [m]
  double place = 0.0;   ///< along the line [m]
  double cosine = 0.0;  ///< of the incidence, 0..1
  double behind = 0.0;  ///< of a hit: how far it lies behind the line, at right angles; negative: in front of it [m]
  double incidence() const { return std::acos(cosine); }  ///< against the normal [rad], 0..pi/2
};
Meeting meet(const ViewRay& ray, const MapLine& line);

}  // namespace phasescan
