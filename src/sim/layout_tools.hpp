/// What the floor plans share: tilings, and how a building's style and doors are drawn.
#pragma once

#include <vector>

#include "sim/floor_plan.hpp"

namespace phasescan::sim {

/// A rectangle of a tiling, walls included.
struct Cell {
  double x0, y0, x1, y1;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
};

/// Splits a cell into rooms none of whose sides is below `least`, until each is near `wanted` square metres.
void split(const Cell& cell, double least, double wanted, std::vector<Cell>& out, Random& random);

/// The room inside a cell: half a wall away from its rim.
RoomPlan inset(const Cell& cell, double wall, RoomUse use, bool stand_here = true);

PlanStyle draw_style(Random& random);

/// Draws each door's state with these probabilities (what is left has no leaf), and whether it is glazed.
void draw_states(FloorPlan& plan, double open, double ajar, double closed, Random& random);

}  // namespace phasescan::sim
