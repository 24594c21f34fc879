/// Surfaces that most beams do not see: glass, which answers head on only, and black ones, which answer from near only.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "map/occupancy_grid.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A scan where it stands on the map, as OccupancyGrid::add_scan takes it.
struct PlacedScan {
  Scan scan;
  Pose2 T_map_laser;  ///< at the first beam
  Twist2 twist;       ///< of the laser during the turn
};

/// Looks for panes in scans at their final poses.
///
/// Glass: over several scans hits lie on one line, each only at the foot of that scan's perpendicular, while in the
/// same scan beams that meet the line obliquely go through or vanish, and no scan sees the same spot obliquely. People,
/// doors that moved and a torn map do not do that: it is the same scan that hits and passes. Black: between two pieces
/// of one wall beams vanish that should have met what is known to stand behind, or that did come back from nearer by. A
/// gap behind which nothing is known (a doorway to a hall larger than the sensor's range) is never claimed.
///
/// @param scan_of  gives the k-th of `count` scans; asked for twice, in order
/// @param grid     the map of the same scans
/// @return sorted by the order in which they were first seen
/// @cost   O(beams) per scan, and per scan and candidate in its reach
std::vector<GlassPane> find_glass(std::size_t count, const std::function<PlacedScan(std::size_t)>& scan_of,
                                  const OccupancyGrid& grid, const GlassOptions& options = {});

/// Cuts out of the panes what is nearer than `keep_open_m` to a place where the way crosses them.
std::vector<GlassPane> cut_where_driven(std::vector<GlassPane> panes, std::span<const Pose2> way, double keep_open_m,
                                        double min_length_m);

/// Cells of a map that a pane lies on, as indices into its `cells`; each once, sorted.
std::vector<std::size_t> cells_of(const TrinaryMap& map, const GlassPane& pane);

}  // namespace phasescan
