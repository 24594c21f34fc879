/// A map as map_server knows it: free, occupied, unknown.
#pragma once

#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "map/occupancy_grid.hpp"

namespace phasescan {

enum class CellState : std::int8_t { kUnknown = -1, kFree = 0, kOccupied = 100 };

struct TrinaryMap {
  int width = 0;   ///< cells along x
  int height = 0;  ///< cells along y
  double resolution_m = 0.05;
  Pose2 origin;                  ///< pose of the lower-left corner of cell (0, 0) on the map
  std::vector<CellState> cells;  ///< row-major from the lower left: cells[k * width + i]

  CellState at(int i, int k) const {
    return cells[static_cast<std::size_t>(k) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
  }
};

/// Cells with a probability of at least 0.65 are occupied, of at most 0.196 free, others and unseen ones unknown;
/// `margin` unknown cells all around.
TrinaryMap make_trinary(const OccupancyGrid& grid, int margin = 4);

}  // namespace phasescan
