// Directions that depend on the range: transmitter and receiver of a triangulating sensor stand side by side.
#pragma once

#include <cmath>

#include "phasescan/core/pose2.hpp"
#include "phasescan/live/sensors.hpp"

namespace phasescan::live {

/// What is added to the turned angle of a range [rad]; 0 for no range. Constants: YDLIDAR's development manuals of X4
/// and SCL, LDROBOT's driver of LD14 (which keeps the last shift where there is no range: there it does not matter).
inline double angle_shift(AngleShift shift, double mm) {
  if (!(mm > 0.0)) return 0.0;
  switch (shift) {
    case AngleShift::kNone:
      return 0.0;
    case AngleShift::kYdTriangle:
      return std::atan(21.8 * (155.3 - mm) / (155.3 * mm));
    case AngleShift::kYdScl:
      return std::atan(17.8 / mm);
    case AngleShift::kLd14:
      return -std::atan((0.11923 * mm - 18.9756) / (mm + 5.9));
  }
  return 0.0;
}

/// RPLIDAR's capsules 84 in the same terms. By Slamtec's decoder, in its fixed-point steps.
inline double ultra_angle_shift(std::uint32_t distance_q2) {
  if (distance_q2 < 200) return -deg_to_rad(7.5);
  const auto k = static_cast<std::int64_t>(98361 / distance_q2);
  return -deg_to_rad(8.0) + static_cast<double>(64 * k + k * k * k / 98304) / 65536.0;
}

/// Of two turned angles, how far on the second one is, in [0, 2 pi).
inline double turned_on(double from, double to) {
  double on = std::fmod(to - from, kTwoPi);
  if (on < 0.0) on += kTwoPi;
  return on;
}

}  // namespace phasescan::live
