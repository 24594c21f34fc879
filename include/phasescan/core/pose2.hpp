/// Angles, and SE(2): planar poses and velocities. Radians everywhere inside, degrees only where a name ends in `_deg`.
/// Frames stand in the variable's name: `T_a_b` takes points of frame b into frame
/// a.
#pragma once

#include <Eigen/Core>
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

/// Planar velocity in the body frame: vx, vy [m/s], omega [rad/s], counter-clockwise.
struct Twist2 {
  double vx = 0.0;
  double vy = 0.0;
  double omega = 0.0;

  bool is_zero() const { return vx == 0.0 && vy == 0.0 && omega == 0.0; }
};

/// Planar rigid motion: x, y [m], theta [rad]. p_a = R(theta) p_b + (x, y) for T_a_b.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  /// The same numbers: headings a whole turn apart are not equal.
  bool operator==(const Pose2&) const = default;

  Eigen::Vector2d translation() const { return {x, y}; }
  Eigen::Matrix2d rotation() const {
    const double c = std::cos(theta), s = std::sin(theta);
    return (Eigen::Matrix2d() << c, -s, s, c).finished();
  }

  /// Takes a point of frame b into frame a.
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const { return rotation() * p + translation(); }

  /// T_a_c = T_a_b * T_b_c, heading wrapped to (-pi, pi].
  Pose2 operator*(const Pose2& other) const {
    const double c = std::cos(theta), s = std::sin(theta);
    return {x + c * other.x - s * other.y, y + s * other.x + c * other.y, wrap_angle(theta + other.theta)};
  }

  /// T_b_a of T_a_b.
  Pose2 inverse() const {
    const double c = std::cos(theta), s = std::sin(theta);
    return {-c * x - s * y, s * x - c * y, wrap_angle(-theta)};
  }

  bool is_finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(theta); }
};

/// Pose after moving with a constant body twist for `seconds` (the exponential map of SE(2), [Sola18] Eq. 156-158).
Pose2 exp_twist(const Twist2& twist, double seconds = 1.0);

/// The constant body twist that reaches `pose` in one second (the logarithm of SE(2)); |theta| <= pi.
Twist2 log_pose(const Pose2& pose);

/// Distance between the origins [m].
inline double translation_distance(const Pose2& a, const Pose2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// Covariance of (x, y, theta) of a * b, given that of b in a's child frame: J C J^T with J = d(a*b)/db.
Eigen::Matrix3d transport_covariance(const Pose2& a, const Eigen::Matrix3d& covariance_b);

/// Covariance of (x, y, theta) of pose.inverse(), given that of pose.
Eigen::Matrix3d invert_covariance(const Pose2& pose, const Eigen::Matrix3d& covariance);

}  // namespace phasescan
