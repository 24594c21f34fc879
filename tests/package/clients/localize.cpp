#include "phasescan/localize/localizer.hpp"

int main() {
  phasescan::TrinaryMap map;
  map.width = map.height = 40;
  map.cells.assign(1600, phasescan::CellState::kFree);
  for (std::size_t i = 0; i < 40; ++i) map.cells[i] = phasescan::CellState::kOccupied;
  return phasescan::LocalizationMap::from_grid(map).views() > 0 ? 0 : 1;
}
