/// Angles: radians everywhere inside, degrees only where a name ends in `_deg`.
#pragma once

#include <cmath>
#include <numbers>

namespace phasescan {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// The same direction in (-pi, pi]. Any finite input; NaN and infinities stay NaN.
inline double wrap_angle(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;  // most are: no division
  const double wrapped = std::remainder(angle, kTwoPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// The same direction in [0, 2 pi).
inline double wrap_positive(double angle) {
  const double wrapped = std::fmod(angle, kTwoPi);
  const double positive = wrapped < 0.0 ? wrapped + kTwoPi : wrapped;
  return positive >= kTwoPi ? 0.0 : positive;
}

/// Unsigned smallest turn between two directions, in [0, pi].
inline double angle_distance(double a, double b) {
  return std::abs(wrap_angle(a - b));
}

inline constexpr double deg_to_rad(double degrees) {
  return degrees * (kPi / 180.0);
}
inline constexpr double rad_to_deg(double radians) {
  return radians * (180.0 / kPi);
}

}  // namespace phasescan
