/// The hits of a scan as Cartesian points in the sensor frame, with a twist taken out of them where one is known.
#pragma once

#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Hits counter-clockwise, structure of arrays: x, y [m]; beam = index into the scan, falling where it turns clockwise.
struct ScanPoints {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> range;
  std::vector<int> beam;

  std::size_t size() const { return x.size(); }
  void clear() {
    x.clear();
    y.clear();
    range.clear();
    beam.clear();
  }
};

/// Fills `out` with the hits of `scan` no farther than `max_range` (0 = all).
///
/// A twist other than zero removes the motion during the turn: every hit is expressed in the sensor frame at the scan's
/// stamp, p = exp(twist * i * time_increment) * p_beam. Without a time_increment the twist has no effect.
/// @cost O(n); allocates only while `out` grows.
void scan_to_points(const Scan& scan, ScanPoints& out, double max_range = 0.0, const Twist2& twist = {});

/// Diagonal of the box around the points [m]; 0 without points.
double extent(const ScanPoints& points);

}  // namespace phasescan
