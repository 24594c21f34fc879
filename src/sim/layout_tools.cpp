#include "sim/layout_tools.hpp"

#include <algorithm>

namespace phasescan::sim {

void split(const Cell& cell, double least, double wanted, std::vector<Cell>& out, Random& random) {
  const double area = cell.width() * cell.height();
  const bool can_x = cell.width() >= 2.0 * least, can_y = cell.height() >= 2.0 * least;
  if ((!can_x && !can_y) || area < wanted * random.uniform(0.8, 1.6)) {
    out.push_back(cell);
    return;
  }
  const bool along_x = can_x && (!can_y || random.chance(cell.width() > cell.height() ? 0.85 : 0.15));
  Cell a = cell, b = cell;
  if (along_x) {
    a.x1 = b.x0 = std::clamp(cell.x0 + cell.width() * random.uniform(0.35, 0.65), cell.x0 + least, cell.x1 - least);
  } else {
    a.y1 = b.y0 = std::clamp(cell.y0 + cell.height() * random.uniform(0.35, 0.65), cell.y0 + least, cell.y1 - least);
  }
  split(a, least, wanted, out, random);
  split(b, least, wanted, out, random);
}

RoomPlan inset(const Cell& cell, double wall, RoomUse use, bool stand_here) {
  const double half = 0.5 * wall;
  return {cell.x0 + half, cell.y0 + half, cell.x1 - half, cell.y1 - half, use, stand_here};
}

PlanStyle draw_style(Random& random) {
  PlanStyle style;
  style.unevenness_m = random.uniform(0.002, 0.012);
  style.warp_m = random.uniform(0.0, 0.04);
  style.shear = random.chance(0.85) ? 0.01 : 0.08;
  style.clutter = random.uniform(0.6, 1.4);
  style.pillars = random.uniform(0.1, 0.4);
  return style;
}

void draw_states(FloorPlan& plan, double open, double ajar, double closed, Random& random) {
  for (DoorPlan& door : plan.doors) {
    const double u = random.uniform();
    door.state = u < open                   ? DoorState::kOpen
                 : u < open + ajar          ? DoorState::kAjar
                 : u < open + ajar + closed ? DoorState::kClosed
                                            : DoorState::kNoLeaf;
    door.glazed = random.chance(0.08);
  }
}

}  // namespace phasescan::sim
