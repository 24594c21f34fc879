/// How far a pose found by aligning points can be trusted.
#pragma once

#include <Eigen/Core>
#include <span>

#include "phasescan/core/pose2.hpp"
#include "scan/points.hpp"

namespace phasescan {

/// A scan point and the reference point it was paired with.
struct PointPair {
  int scan = 0;
  int reference = 0;
};

/// Largest variance that is stated: nothing is known of that direction.
inline constexpr double kUnknownVariance = 1e6;

/// Inverse of an information matrix of (x, y, theta), with every variance capped at kUnknownVariance.
Eigen::Matrix3d covariance_from_information(const Eigen::Matrix3d& information);

/// Covariance of (x, y, theta) in the reference frame of a pose found from point pairs.
///
/// Each pair counts across the reference's surface only (point-to-line information): along a surface a point says
/// nothing, so the covariance is wide along a corridor whatever the point-to-point residuals are. Surface directions
/// come from a line through the reference's neighbouring beams. The noise is the spread of the pairs across the
/// surface, at least 1 cm; as neighbouring beams share errors (discretisation, partners between beams), the inverse
/// information is inflated by 4.
/// @cost O(pairs), allocates nothing
Eigen::Matrix3d surface_covariance(const ScanPoints& reference, const ScanPoints& scan, const Pose2& T_ref_scan,
                                   std::span<const PointPair> pairs);

}  // namespace phasescan
