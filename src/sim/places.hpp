/// Places for retrieval: scans of many flats, no two places within a metre, and a query beside each.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"
#include "sim/lidar.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim {

/// A place, and a query from within `reach_m` in line of sight with any heading.
struct Place {
  std::uint64_t building = 0;  ///< places of different buildings have nothing in common
  Pose2 T_world_place;
  Scan scan;
  Pose2 T_world_query;
  Scan query;
  /// Numbers within the building of all places that the query stands within reach of, in line of sight, ascending: this
  /// one and any other that would be as right an answer.
  std::vector<std::uint32_t> in_reach;
};

struct PlacesOptions {
  WorldKind world = WorldKind::kFlat;
  double apart_m = 1.0;  ///< no two places of a building are nearer
  double reach_m = 1.0;  ///< a query is no farther from its place
  double clearance_m = 0.25;
};

/// All places of building k: the same for the same seed, whatever else was made. Concatenate buildings 0, 1, .. until
/// there are enough; a flat gives about 30.
std::vector<Place> make_places(const PlacesOptions& options, const LidarOptions& lidar, std::uint64_t seed,
                               std::uint64_t building);

}  // namespace phasescan::sim
