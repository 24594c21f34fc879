/// Simulated worlds: line segments and discs with materials, the rooms a sensor may stand in and the doorways between
/// them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"

namespace phasescan::sim {

/// How a surface answers a beam.
enum class Material : std::uint8_t {
  kMatt,   ///< seen at any but grazing incidence
  kBlack,  ///< absorbing: seen only from near
  kGlass,  ///< seen only near normal incidence, else the beam goes through
};

using Polygon = std::vector<Eigen::Vector2d>;

/// A flat surface from a to b [m], seen from both sides.
struct Segment {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  Material material = Material::kMatt;
};

/// A round surface: pillar, leg, bin [m].
struct Disc {
  Eigen::Vector2d center;
  double radius = 0.0;
  Material material = Material::kMatt;
};

/// Surfaces, and the closed outlines among them that nothing can stand in.
struct Shape {
  std::vector<Segment> segments;
  std::vector<Disc> discs;
  std::vector<Polygon> solids;

  /// Adds an open polyline.
  void add_line(const Polygon& points, Material material = Material::kMatt);
  /// Adds a closed outline as a solid.
  void add_solid(const Polygon& outline, Material material = Material::kMatt);
  /// Adds an axis-aligned box, given its centre and full size, as a solid.
  void add_box(const Eigen::Vector2d& center, double width, double depth, Material material = Material::kMatt);
  void add_disc(const Eigen::Vector2d& center, double radius, Material material = Material::kMatt);
  /// Adds another shape, taken from its frame into this one.
  void append(const Shape& other, const Pose2& T_this_other = {});
  bool empty() const { return segments.empty() && discs.empty(); }

  /// Distance from `p` to the nearest surface [m], 0 inside a solid or disc, infinity without surfaces. O(n).
  double clearance(const Eigen::Vector2d& p) const;
};

/// A gap in a wall that one can pass, from a to b across the passage.
struct Doorway {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

/// A thing of a world that can be moved: its pieces in the world's shape, from the first to before the last.
struct MovablePart {
  enum class Kind : std::uint8_t { kFurniture, kDoorLeaf };
  Kind kind = Kind::kFurniture;
  std::size_t first_segment = 0, last_segment = 0, first_disc = 0, last_disc = 0, first_solid = 0, last_solid = 0;
};

/// A place to be in. Frame `world`: metres, right-handed.
struct World {
  std::string name;
  Shape shape;
  std::vector<Polygon> rooms;  ///< outlines of the places a sensor may stand in, furniture included
  std::vector<Doorway> doors;  ///< the open ones
  std::vector<MovablePart> parts;
};

/// True inside the polygon (even-odd rule); points on the outline may fall on either side.
bool inside_polygon(const Polygon& polygon, const Eigen::Vector2d& p);

/// Distance from a point to a segment [m].
double point_segment_distance(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

}  // namespace phasescan::sim
