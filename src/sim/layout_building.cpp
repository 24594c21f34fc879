/// A large building: corridors that form loops, blocks of rooms between them.
#include <algorithm>
#include <vector>

#include "sim/layout_tools.hpp"
#include "sim/layouts.hpp"

namespace phasescan::sim {

FloorPlan plan_building(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  // Out of square would be metres over this length.
  plan.style.shear = 0.003;
  const double wall = random.uniform(0.12, 0.2), corridor = random.uniform(1.8, 2.4);
  const int columns = 2 + static_cast<int>(random.below(3)), rows = 2 + static_cast<int>(random.below(2));
  std::vector<double> x{0.0}, y{0.0};
  for (int i = 0; i < columns; ++i) x.push_back(x.back() + random.uniform(7.0, 11.0));
  for (int i = 0; i < rows; ++i) y.push_back(y.back() + random.uniform(6.5, 10.0));

  // Corridors run below and above every block row, and between the blocks: index of the long ones first.
  std::vector<Cell> cells;
  const auto shifted_x = [&](int i) { return x[static_cast<std::size_t>(i)] + i * corridor; };
  const auto shifted_y = [&](int i) { return y[static_cast<std::size_t>(i)] + i * corridor; };
  const double right = shifted_x(columns) + corridor;
  std::vector<RoomUse> uses;
  for (int r = 0; r <= rows; ++r) {
    const double low = shifted_y(r);
    cells.push_back({0.0, low, right, low + corridor});
    uses.push_back(RoomUse::kCorridor);
  }
  const std::size_t first_cross = cells.size();
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      // A passage is left out now and then; the outer ones stay, so that loops remain.
      if (c != 0 && c != columns && random.chance(0.25)) continue;
      cells.push_back({shifted_x(c), shifted_y(r) + corridor, shifted_x(c) + corridor, shifted_y(r + 1)});
      uses.push_back(RoomUse::kCorridor);
    }
  }
  const std::size_t corridors = cells.size();
  constexpr RoomUse rooms[] = {RoomUse::kOffice, RoomUse::kOffice,  RoomUse::kOffice,
                               RoomUse::kLiving, RoomUse::kKitchen, RoomUse::kBedroom};
  for (int r = 0; r < rows; ++r) {
    double from = corridor;
    for (int c = 1; c <= columns; ++c) {
      const double passage = shifted_x(c);
      const bool open = std::any_of(cells.begin() + static_cast<std::ptrdiff_t>(first_cross),
                                    cells.begin() + static_cast<std::ptrdiff_t>(corridors), [&](const Cell& cell) {
                                      return cell.x0 == passage && cell.y0 == shifted_y(r) + corridor;
                                    });
      if (!open) continue;
      split({from, shifted_y(r) + corridor, passage, shifted_y(r + 1)}, 2.8, 14.0, cells, random);
      from = passage + corridor;
    }
  }
  for (std::size_t i = uses.size(); i < cells.size(); ++i) uses.push_back(rooms[random.below(6)]);
  for (std::size_t i = 0; i < cells.size(); ++i) plan.rooms.push_back(inset(cells[i], wall, uses[i]));

  // Corridors open into each other over their whole width; every room has a door to a corridor, or else to a neighbour.
  for (std::size_t i = first_cross; i < corridors; ++i) {
    for (std::size_t k = 0; k < first_cross; ++k) {
      add_door(plan, static_cast<int>(i), static_cast<int>(k), plan.rooms[i].width() - 0.25, wall, random);
    }
  }
  const std::size_t openings = plan.doors.size();
  for (std::size_t i = corridors; i < cells.size(); ++i) {
    std::vector<std::size_t> order(corridors);
    for (std::size_t k = 0; k < corridors; ++k) order[k] = k;
    const std::size_t turn = random.below(corridors);
    std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(turn), order.end());
    const auto opens_to = [&](std::size_t k) {
      return add_door(plan, static_cast<int>(k), static_cast<int>(i), random.uniform(0.85, 1.0), wall, random);
    };
    if (std::any_of(order.begin(), order.end(), opens_to)) continue;
    for (std::size_t k = corridors; k < cells.size(); ++k) {
      if (k != i && opens_to(k)) break;
    }
  }
  draw_states(plan, 0.75, 0.12, 0.03, random);
  for (std::size_t i = 0; i < openings; ++i) plan.doors[i].state = DoorState::kNoLeaf;
  return plan;
}

}  // namespace phasescan::sim
