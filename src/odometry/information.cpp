#include "phasescan/odometry/information.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace phasescan {
namespace {

constexpr double kNormalNoise =
    0.01;  // variance of the normals [rad^2]: the share of information they leak along a surface

}  // namespace

Eigen::Matrix3d rotate_information(const Eigen::Matrix3d& matrix, double theta) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  const double c = std::cos(theta), s = std::sin(theta);
  R.topLeftCorner<2, 2>() << c, -s, s, c;
  return R * matrix * R.transpose();
}

Eigen::Matrix3d believed_information(const Eigen::Matrix3d& information) {
  Eigen::Matrix3d seen = kMatchTrust * information;
  const double leak = kNormalNoise * seen.topLeftCorner<2, 2>().trace();
  seen(0, 0) -= leak;
  seen(1, 1) -= leak;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(seen);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace phasescan
