/// The surface of one scan as points with normals in the frame of the robot's base: what maps are made of.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Hits, structure of arrays, in the frame of the base. Those on a fitted line have a normal and count across it; lone
/// hits have the normal (0, 0) and count in both directions.
struct MapPoints {
  std::vector<float> x, y;                  ///< the hit [m]
  std::vector<float> nx, ny;                ///< unit normal towards the sensor, (0, 0) for a lone hit
  std::vector<float> variance;              ///< of the hit across the surface, or in each direction [m^2]
  std::vector<float> normal_variance;       ///< of the normal's direction [rad^2]
  std::vector<std::uint8_t> free_standing;  ///< 1: on a narrow object that stands free (see free_standing.hpp)
  std::size_t with_normal = 0;

  std::size_t size() const { return x.size(); }
  bool lone(std::size_t i) const { return nx[i] == 0.0F && ny[i] == 0.0F; }
  void clear();
  void reserve(std::size_t hits);
  /// Appends hit `i` of `other`.
  void append(const MapPoints& other, std::size_t i);

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("x", self.x);
    v("y", self.y);
    v("nx", self.nx);
    v("ny", self.ny);
    v("variance", self.variance);
    v("normal_variance", self.normal_variance);
    v("free_standing", self.free_standing);
    v("with_normal", self.with_normal);
  }
};

/// Walls as `find_surface` shall follow them where a map of them is tracked.
inline constexpr WallLines kTrackingLines{1.0, 2.0, 4.0};

/// Takes the hits into the frame of the base; hits beyond `max_range_m` are left out. Hits far apart on a wall seen at
/// a grazing angle, too sparse for a fitted line, get the normal of the line through their neighbours: by themselves
/// they would look like things that move with the sensor.
/// @param beams  if given: of each point, the index into the scan
void to_map_points(const SurfacePoints& surface, const Pose2& T_base_laser, double max_range_m, MapPoints& out,
                   std::vector<int>* beams = nullptr);

}  // namespace phasescan
