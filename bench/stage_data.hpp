/// Input for the stage benchmarks: two scans of the same room.
#pragma once

#include "fft_icp/image/rasterize.hpp"
#include "support/rooms.hpp"

namespace phasescan::bench {

inline const Pose2 kMotion{0.4, -0.3, 1.2};

inline Scan reference_scan(int beams) {
  return test::cast_room({}, beams, 0.01, 0.02, 1);
}
inline Scan moved_scan(int beams) {
  return test::cast_room(kMotion, beams, 0.01, 0.02, 2);
}

inline ScanPoints points_of(const Scan& scan) {
  ScanPoints points;
  scan_to_points(scan, points);
  return points;
}

/// A scan image as the matchers draw it.
inline Image image_of(const Scan& scan, int size, double theta = 0.0) {
  const ImageOptions options;
  Image image;
  Rasterizer(options.blur_px, options.connect_m).draw(points_of(scan), theta, {size, options.dmax_m}, image);
  return image;
}

}  // namespace phasescan::bench
