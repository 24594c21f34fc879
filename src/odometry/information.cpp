#include "odometry/information.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace phasescan {

Eigen::Matrix3d rotate_information(const Eigen::Matrix3d& matrix, double theta) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const double c = std::cos(theta), s = std::sin(theta);
  R.topLeftCorner<2, 2>() << c, -s, s, c;
  return R * matrix * R.transpose();
}

Eigen::Matrix3d carry_covariance(const Eigen::Matrix3d& covariance, const Eigen::Vector2d& ahead) {
  Eigen::Matrix3d lever = Eigen::Matrix3d::Identity();
  lever(0, 2) = -ahead.y();
  lever(1, 2) = ahead.x();
  return lever * covariance * lever.transpose();
}

Eigen::Matrix3d positive_part(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

Eigen::Matrix3d chain_covariance(const Pose2& T_odom_keyframe, const Eigen::Matrix3d& keyframe,
                                 const Pose2& T_odom_base, const Eigen::Matrix3d& since) {
  // A wrong heading of the keyframe turns the way since then about it.
  const Eigen::Matrix3d carried = carry_covariance(keyframe, T_odom_base.translation() - T_odom_keyframe.translation());
  const Eigen::Matrix3d sum = carried + rotate_information(since, T_odom_base.theta);
  return 0.5 * (sum + sum.transpose());
}

}  // namespace phasescan
