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

Eigen::Matrix3d positive_part(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(matrix);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace phasescan
