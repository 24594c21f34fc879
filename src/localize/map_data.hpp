/// What a LocalizationMap holds.
#pragma once

#include "localize/map_grid.hpp"
#include "localize/view_table.hpp"
#include "odometry/local_map.hpp"
#include "odometry/registration.hpp"
#include "phasescan/localize/localizer.hpp"

namespace phasescan {

struct LocalizationMap::Data {
  Pose2 T_map_grid;
  MapGrid grid;
  LocalMap coarse, fine;  ///< surfels, placed in the frame of the grid; the first with a wide reach
  ViewTable views;
  double free_area_m2 = 0.0;
  std::size_t surface_points = 0;
  double view_spacing_m = 0.0, view_range_m = 0.0;  ///< options that the views were made with
};

/// @throws std::invalid_argument for cells that are not width x height or too many, and numbers that are not finite
void check_map(const TrinaryMap& map);

/// What is made of grid and surface and takes no time: surfels and the free area. @throws std::invalid_argument where
/// there is no free space or no surface
void add_surfels(LocalizationMap::Data& data, const MapPoints& surface);

/// Registers points on one of the maps, with poses in the frame of the grid.
inline Registration register_on_grid(const LocalMap& map, const MapPoints& points, const Pose2& T_grid_base,
                                     const RegistrationOptions& options,
                                     const std::optional<PosePrior>& prior_on_grid = std::nullopt) {
  const Pose2& T_grid_map = map.T_world_map();  // without a turn: information stays as it is
  const Pose2 T_map_grid = T_grid_map.inverse();
  std::optional<PosePrior> prior = prior_on_grid;
  if (prior) prior->T_map_base = T_map_grid * prior->T_map_base;
  Registration found = register_points(map, points, T_map_grid * T_grid_base, options, prior);
  found.T_map_base = T_grid_map * found.T_map_base;
  return found;
}

}  // namespace phasescan
