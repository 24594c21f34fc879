/// Scans cast in a small room without symmetries, for tests that need a known motion.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::test {

struct Wall {
  double x0, y0, x1, y1;
};

/// An L-shaped room of 6 x 5 m with a cupboard and a pillar; the origin lies inside.
inline const std::vector<Wall>& room_walls() {
  static const std::vector<Wall> kWalls{{-2.5, -2.0, 3.5, -2.0}, {3.5, -2.0, 3.5, 1.5},  {3.5, 1.5, 1.5, 1.5},
                                        {1.5, 1.5, 1.5, 3.0},    {1.5, 3.0, -2.5, 3.0},  {-2.5, 3.0, -2.5, -2.0},
                                        {2.2, -2.0, 2.2, -1.4},  {2.2, -1.4, 3.1, -1.4}, {3.1, -1.4, 3.1, -2.0},
                                        {-1.7, 1.6, -1.3, 1.8},  {-1.3, 1.8, -1.5, 2.2}, {-1.5, 2.2, -1.9, 2.0},
                                        {-1.9, 2.0, -1.7, 1.6}};
  return kWalls;
}

/// Ranges seen at `pose` of a sensor with `beams` beams a turn starting at `angle_min`; sigma of Gaussian noise [m], a
/// share of the beams lost. Beams that hit nothing within range_max are missing (0).
inline Scan cast_room(const Pose2& pose, int beams, double sigma = 0.0, double lost = 0.0, std::uint64_t seed = 1,
                      double range_max = 6.0, double angle_min = -kPi, bool clockwise = false) {
  Random random(seed);
  const double increment = (clockwise ? -kTwoPi : kTwoPi) / beams;
  std::vector<float> ranges(static_cast<std::size_t>(beams), 0.0F);
  for (int i = 0; i < beams; ++i) {
    const double angle = pose.theta + angle_min + i * increment;
    const double dx = std::cos(angle), dy = std::sin(angle);
    double best = std::numeric_limits<double>::infinity();
    for (const Wall& w : room_walls()) {
      const double ex = w.x1 - w.x0, ey = w.y1 - w.y0, det = dx * ey - dy * ex;
      if (std::abs(det) < 1e-12) continue;
      const double qx = w.x0 - pose.x, qy = w.y0 - pose.y;
      const double t = (qx * ey - qy * ex) / det, u = (qx * dy - qy * dx) / det;
      if (t > 1e-6 && u >= 0.0 && u <= 1.0 && t < best) best = t;
    }
    const double noisy = best + random.normal(0.0, sigma);
    if (noisy < range_max && noisy > 0.15 && !random.chance(lost))
      ranges[static_cast<std::size_t>(i)] = static_cast<float>(noisy);
  }
  return make_scan(ranges, {angle_min, increment, 0.15, range_max});
}

}  // namespace phasescan::test
