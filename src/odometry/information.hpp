/// Information and covariance matrices of planar poses (x, y, theta).
#pragma once

#include <Eigen/Core>

#include "odometry/degeneracy.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// Share of a match's formal information that counts: the points of a scan are not independent of each other. Chosen
/// by hand on the recorded logs.
inline constexpr double kMatchTrust = 0.1;

/// Turns an information or covariance matrix of (x, y, theta) into a frame in which vectors appear turned by `theta`.
Eigen::Matrix3d rotate_information(const Eigen::Matrix3d& matrix, double theta);

/// What an error (x, y, theta) at a point is at another one that lies `ahead` of it, axes alike: a wrong heading moves
/// what lies ahead.
Eigen::Matrix3d carry_covariance(const Eigen::Matrix3d& covariance, const Eigen::Vector2d& ahead);

/// A symmetric matrix with its negative eigenvalues set to 0.
Eigen::Matrix3d positive_part(const Eigen::Matrix3d& matrix);

/// Covariance of (x, y, theta) of T_odom_keyframe * T_keyframe_base along the axes of odom.
/// @param keyframe  covariance of T_odom_keyframe along the axes of odom
/// @param since     of T_keyframe_base, frame of the base
Eigen::Matrix3d chain_covariance(const Pose2& T_odom_keyframe, const Eigen::Matrix3d& keyframe,
                                 const Pose2& T_odom_base, const Eigen::Matrix3d& since);

}  // namespace phasescan
