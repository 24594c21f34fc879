#include "odometry/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "odometry/information.hpp"

namespace phasescan {
namespace {

// [1/m^2, 1/rad^2] added so that an information with an open direction can be inverted: 30 m there.
constexpr double kInvertible = 1e-3;

}  // namespace

double largest_deviation(const Eigen::Matrix3d& information) {
  const Eigen::Matrix2d covariance =
      (information + kInvertible * Eigen::Matrix3d::Identity()).inverse().topLeftCorner<2, 2>();
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(0.5 * covariance.trace() + std::hypot(half, covariance(0, 1)));
}

WeakDirection weakest_direction(const Eigen::Matrix3d& information) {
  const Eigen::Matrix3d covariance = (information + kInvertible * Eigen::Matrix3d::Identity()).inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(covariance.topLeftCorner<2, 2>());
  const Eigen::Vector3d u = covariance.leftCols<2>() * eigen.eigenvectors().col(1);
  return {u / u.head<2>().norm(), eigen.eigenvalues()(0) / eigen.eigenvalues()(1)};
}

bool determines_position(const Eigen::Matrix3d& information, double most_sigma_m) {
  return largest_deviation(information) < most_sigma_m;
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

Eigen::Matrix2d step_covariance_of(const Eigen::Matrix3d& seen, double turn) {
  const Eigen::Matrix3d weak = Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal();
  return rotate_information((seen + weak).inverse(), turn).topLeftCorner<2, 2>();
}

}  // namespace phasescan
