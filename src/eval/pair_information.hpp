/// What two recorded scans hold of the pose between them, where no simulator can say it.
#pragma once

#include <Eigen/Core>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Fisher information of (x, y, theta) of T_ref_scan, in the reference frame, from the surfaces that both scans show at
/// that pose: as sim::pair_information, but with the surfaces, normals and noise read off the scans themselves. Its
/// weakest direction tells a bare corridor. What the scans say of surface that only one of them shows counts nothing.
/// @cost O(n m)
Eigen::Matrix3d surface_information(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan);

}  // namespace phasescan
