#include "odometry/information.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
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

double largest_deviation(const Eigen::Matrix3d& information) {
  const Eigen::Matrix2d covariance = information.inverse().topLeftCorner<2, 2>();
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(0.5 * covariance.trace() + std::hypot(half, covariance(0, 1)));
}

LeastSeen least_seen(const Eigen::Matrix3d& information) {
  const Eigen::Matrix3d covariance = (information + 1e-3 * Eigen::Matrix3d::Identity()).inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance.topLeftCorner<2, 2>());
  const Eigen::Vector3d u = covariance.leftCols<2>() * eigen.eigenvectors().col(1);
  return {u / u.head<2>().norm(), eigen.eigenvalues()(0) / eigen.eigenvalues()(1)};
}

void bound_translation(Eigen::Matrix3d& covariance, double most_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance.topLeftCorner<2, 2>());
  for (int k = 0; k < 2; ++k) {
    const double sigma = std::sqrt(std::max(0.0, eigen.eigenvalues()(k)));
    if (sigma <= most_m) continue;
    const Eigen::Vector2d u = eigen.eigenvectors().col(k);
    Eigen::Matrix3d shrink = Eigen::Matrix3d::Identity();
    shrink.topLeftCorner<2, 2>() -= (1.0 - most_m / sigma) * u * u.transpose();
    covariance = shrink * covariance * shrink;
  }
}

Eigen::Matrix2d doubt_of(const Eigen::Matrix3d& seen, double turn) {
  const Eigen::Matrix3d weak = Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal();
  return rotate_information((seen + weak).inverse(), turn).topLeftCorner<2, 2>();
}

bool sees_both_ways(const Eigen::Matrix3d& information) {
  constexpr double kSeenM = 0.2;
  const Eigen::Matrix3d weak = 1e-3 * Eigen::Matrix3d::Identity();
  return largest_deviation(information + weak) < kSeenM;
}

}  // namespace phasescan
