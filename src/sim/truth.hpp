/// What can be known of a pair at best: the surface both scans see, and the information in their noisy ranges.
#pragma once

#include <Eigen/Core>

#include "sim/lidar.hpp"

namespace phasescan::sim {

/// Shares of the noise-free hits of each scan that lie on surface the other pose sees too (in its field of view and
/// range, and within a few centimetres of what stops its ray).
struct Overlap {
  double of_scan = 0.0;
  double of_reference = 0.0;
  double mean() const { return 0.5 * (of_scan + of_reference); }
};

Overlap pair_overlap(const Surroundings& around_ref, const Surroundings& around_scan, const LidarOptions& lidar,
                     const Pose2& T_world_ref, const Pose2& T_world_scan);

/// Fisher information of (x, y, theta) of T_ref_scan, in the reference frame, from the ranges of both scans on surface
/// that both see and whose shape is not known beforehand.
///
/// A stretch of surface gives one equation, its place along its normal. Each scan knows it with a density of
/// information of 1 / (range * step * sigma(range)^2 * cos(incidence)) per metre; for the pose the two act in series,
/// as the surface itself is unknown. A beam that looks past its stated direction is off by range * sin(incidence) along
/// the normal; whole revolutions that turn add to the pose's covariance. Beams lost by chance or at grazing incidence
/// are accounted for, mixed pixels, lost sectors, wrong start angles and tilt are not. J^-1 is the Cramer-Rao bound of
/// the match. @cost two noise-free scans and as many rays again.
Eigen::Matrix3d pair_information(const Surroundings& around_ref, const Surroundings& around_scan,
                                 const LidarOptions& lidar, const Pose2& T_world_ref, const Pose2& T_world_scan);

}  // namespace phasescan::sim
