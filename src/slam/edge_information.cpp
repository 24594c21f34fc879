#include "edge_information.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace phasescan {
namespace {

constexpr double kFloorM = 0.01, kFloorRad = 0.004;  // standard deviation that no match gets below

}  // namespace

Eigen::Matrix3d edge_information(const Eigen::Matrix3d& information, double weak_m, double weak_rad) {
  const Eigen::Matrix3d weak =
      Eigen::Vector3d(1.0 / (weak_m * weak_m), 1.0 / (weak_m * weak_m), 1.0 / (weak_rad * weak_rad)).asDiagonal();
  Eigen::Matrix3d covariance = (information + weak).inverse();
  covariance.diagonal() += Eigen::Vector3d(kFloorM * kFloorM, kFloorM * kFloorM, kFloorRad * kFloorRad);
  const Eigen::Matrix3d result = covariance.inverse();
  if (!result.allFinite() || result.llt().info() != Eigen::Success) return weak;
  return 0.5 * (result + result.transpose());
}

}  // namespace phasescan
