/// The surfaces of a map: where occupied cells border on free ones, as points with normals.
#pragma once

#include "localize/map_grid.hpp"
#include "odometry/map_points.hpp"

namespace phasescan {

/// Points in the frame of the grid; normals face free space. A wall as thin as a cell has a point on either side.
/// @cost O(border cells)
MapPoints map_surface(const MapGrid& grid);

}  // namespace phasescan
