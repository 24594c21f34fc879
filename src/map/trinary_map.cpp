#include "map/occupancy_grid.hpp"

namespace phasescan {
namespace {

constexpr double kOccupied = 0.619, kFree = -1.411;  // log-odds of 0.65 and 0.196

}  // namespace

TrinaryMap make_trinary(const OccupancyGrid& grid, int margin) {
  const OccupancyGrid::Bounds b = grid.bounds();
  TrinaryMap map;
  map.resolution_m = grid.resolution();
  if (b.max_i < b.min_i) {
    map.width = map.height = 1;
    map.cells = {CellState::kUnknown};
    return map;
  }
  map.width = b.max_i - b.min_i + 1 + 2 * margin;
  map.height = b.max_k - b.min_k + 1 + 2 * margin;
  map.origin = {(b.min_i - margin) * map.resolution_m, (b.min_k - margin) * map.resolution_m, 0.0};
  map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), CellState::kUnknown);
  for (int k = b.min_k; k <= b.max_k; ++k) {
    for (int i = b.min_i; i <= b.max_i; ++i) {
      const double value = grid.log_odds(i, k);
      CellState& cell = map.cells[static_cast<std::size_t>(k - b.min_k + margin) * static_cast<std::size_t>(map.width) +
                                  static_cast<std::size_t>(i - b.min_i + margin)];
      if (value >= kOccupied)
        cell = CellState::kOccupied;
      else if (value <= kFree)
        cell = CellState::kFree;
    }
  }
  return map;
}

}  // namespace phasescan
