#include "phasescan/core/pose2.hpp"

namespace phasescan {
namespace {

/// sin(t)/t and (1 - cos(t))/t, by series near 0.
void left_jacobian_terms(double t, double& a, double& b) {
  if (std::abs(t) < 1e-4) {
    a = 1.0 - t * t / 6.0;
    b = 0.5 * t - t * t * t / 24.0;
  } else {
    a = std::sin(t) / t;
    b = (1.0 - std::cos(t)) / t;
  }
}

}  // namespace

Pose2 exp_twist(const Twist2& twist, double seconds) {
  const double theta = twist.omega * seconds, dx = twist.vx * seconds, dy = twist.vy * seconds;
  double a = 0.0, b = 0.0;
  left_jacobian_terms(theta, a, b);
  return {a * dx - b * dy, b * dx + a * dy, wrap_angle(theta)};
}

Twist2 log_pose(const Pose2& pose) {
  double a = 0.0, b = 0.0;
  left_jacobian_terms(pose.theta, a, b);
  const double scale = 1.0 / (a * a + b * b);
  return {scale * (a * pose.x + b * pose.y), scale * (-b * pose.x + a * pose.y), pose.theta};
}

Eigen::Matrix3d transport_covariance(const Pose2& a, const Eigen::Matrix3d& covariance_b) {
  Eigen::Matrix3d j = Eigen::Matrix3d::Identity();
  j.topLeftCorner<2, 2>() = a.rotation();
  return j * covariance_b * j.transpose();
}

Eigen::Matrix3d invert_covariance(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  // t' = -R^T t, theta' = -theta; dt' = -R^T dt + (dR^T/dtheta) t part: column (c y - s x ..) below.
  const double c = std::cos(pose.theta), s = std::sin(pose.theta);
  Eigen::Matrix3d j;
  j << -c, -s, s * pose.x - c * pose.y, s, -c, c * pose.x + s * pose.y, 0.0, 0.0, -1.0;
  return j * covariance * j.transpose();
}

}  // namespace phasescan
