/// What an edge of the graph is allowed to claim.
#pragma once

#include <Eigen/Core>

namespace phasescan {

/// Information of an edge from that of its match, in the same frame: never better than 1 cm and 0.2 degrees, never
/// without a weak word of `weak_m` and `weak_rad`. Symmetric and positive definite whatever comes.
Eigen::Matrix3d edge_information(const Eigen::Matrix3d& information, double weak_m, double weak_rad);

}  // namespace phasescan
