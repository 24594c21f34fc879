/// Where along a wall a scan fits: what niches, frames and ends of walls say where lines alone say nothing.
#pragma once

#include <Eigen/Core>

#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/registration.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// What poses along one direction say of a scan.
struct DirectionFit {
  double offset_m = 0.0;     ///< from the pose given to the mean of what the scan and the prior leave
  double information = 0.0;  ///< of the scan alone, as a registration counts it [1/m^2]
};

/// Tries poses up to 0.3 m to either side of `T_map_base` along `direction`. Registration by lines sees only how far
/// hits are from the line they are nearest to; a hit on the back of a niche 10 cm deep lies on the wrong wall as soon
/// as the pose moves along, and that tells. Hits beyond what the map knows tell nothing.
/// @param prior  of the pose
/// @cost about 40 x 250 look-ups
DirectionFit fit_along(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base,
                       const Eigen::Vector3d& direction, const PosePrior& prior);

/// Where a registration leaves a direction open (see determines_position), moves it along that direction to where the
/// scan fits best and adds what that says.
void resolve_degenerate_direction(const LocalMap& map, const MapPoints& points, const PosePrior& prior,
                                  Registration& found);

}  // namespace phasescan
