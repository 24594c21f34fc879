/// How likely a scan is at a pose: where its hits lie on the map, and what their rays went through.
#pragma once

#include "localize/map_grid.hpp"
#include "localize/query_scan.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

/// @param through  whether rays are followed: what lies between the laser and a hit speaks against the pose
/// @param stride   every so many beams alone
/// @cost about 10 ns a beam, 100 ns where rays are followed
MapFit fit_to_map(const MapGrid& grid, const JudgedBeams& beams, const Pose2& T_grid_base, bool through = true,
                  std::size_t stride = 1);

/// Natural logarithm of the likelihood of one hit at this distance from the nearest surface, 0 at none.
/// @param variance  of sensor and map together [m^2]
float hit_log_likelihood(float distance_m, float variance);

/// What the map adds to the variance of a hit [m^2].
float map_variance(const MapGrid& grid);

}  // namespace phasescan
