/// The hits of a scan with the surface they lie on: normals, noise, and how much wall each beam stands for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Standard deviation of a range: max(floor_m, per_metre * range).
struct RangeNoise {
  float floor_m = 0.01F;
  float per_metre = 0.01F;

  float sigma(float range) const {
    const float grows = per_metre * range;
    return grows > floor_m ? grows : floor_m;
  }
};

/// A hit and the line that its neighbours and it lie on: what inner loops read, in half a cache line.
struct SurfacePoint {
  float x = 0, y = 0;            ///< the hit [m]
  float line_x = 0, line_y = 0;  ///< the hit moved onto the line [m]
  float nx = 0, ny = 0;          ///< unit normal towards the sensor; (0, 0) where no line fits
  float length = 0;              ///< length of surface the beam stands for [m]
  float variance = 0;            ///< of the hit along the normal, from the range noise [m^2]

  bool has_normal() const { return nx != 0.0F || ny != 0.0F; }
};

/// Hits in order of direction, in the sensor frame at the scan's stamp.
struct SurfacePoints {
  std::vector<SurfacePoint> points;
  std::vector<float> range;            ///< [m]
  std::vector<float> sigma;            ///< standard deviation of the range [m]
  std::vector<float> normal_variance;  ///< of the normal's direction, from the noise and the fitted length [rad^2]
  std::vector<int> beam;               ///< index into the scan
  RangeNoise noise;                    ///< estimated from the scan itself
  double extent = 0.0;                 ///< range that 95 % of the hits do not exceed [m]
  double spacing = 0.0;                ///< mean angle between beams [rad]

  std::size_t size() const { return points.size(); }
  const SurfacePoint& operator[](std::size_t i) const { return points[i]; }
};

/// Some of a scan's hits, structure of arrays, as vector code asks for them: padded to whole vectors with entries whose
/// weight is 0 and that face nowhere.
struct SurfaceBatch {
  static constexpr std::size_t kPadding = 16;
  std::vector<float> x, y, nx, ny, length, variance, sigma, weight;
  std::size_t count = 0;  ///< without the padding

  std::size_t padded() const { return x.size(); }
  /// Copies the hits named by `indices`. @cost O(indices)
  void fill(const SurfacePoints& surface, std::span<const int> indices);
  /// Copies all hits.
  void fill(const SurfacePoints& surface);

 private:
  void resize(std::size_t hits);
  void put(std::size_t k, const SurfacePoint& point, float point_sigma);
};

/// Buffers of `find_surface`, kept between calls. Directions of beams are kept too, while scans of one geometry come.
struct SurfaceWorkspace {
  double angle_min = 0.0, angle_increment = 0.0;  ///< of the directions at hand
  bool directions_known = false;                  ///< false: of none, or listed ones
  std::vector<double> angle;
  std::vector<int> order;
  std::vector<double> cos_angle, sin_angle;
  std::vector<double> x, y, sums;  ///< of the hits; prefix sums of x, y, xx, xy, yy
  std::vector<std::int32_t> segment_begin, segment_end, half;
  std::vector<double> lines;
  std::vector<std::uint8_t> found;
  std::vector<float> hits, scratch, near, far;
};

/// How far walls are followed: the mean square across a longer line, in variances of the range noise, up to which it is
/// taken for one. Short lines keep the shape of furniture and the relief of walls, which tell one scan from another;
/// where noise hides that relief, short lines have normals that sway, and along a bare wall these look like something
/// seen.
struct WallLines {
  double straightness = 1.0;
  double noisy_straightness = 1.0;  ///< where the noise near the sensor is 2 cm and more; in between from 1 cm on
  /// Variance along the line that is asked for, of what the noise scatters along it: a few hits close together lie
  /// along their beams by that alone, and seem a wall that faces along the scanner's way.
  double least_spread = 0.0;
};

/// Finds points, noise and normals of a scan.
///
/// Lines are fitted to the neighbours in direction on the same surface, over a length that grows with noise and range;
/// at a corner the side that fits better is taken. The noise is read off the second differences of the ranges. A twist
/// other than zero removes the motion during the turn (see scan_to_points).
/// @cost O(n log n) at worst (unsorted per-beam angles), O(n) for regular scans.
void find_surface(const Scan& scan, const Twist2& twist, SurfaceWorkspace& work, SurfacePoints& out,
                  const WallLines& lines = {});

}  // namespace phasescan
