#include "sim/layouts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/layout_tools.hpp"

namespace phasescan::sim {
namespace {

/// Windows down to the floor and glass doors to the outside, which a low sensor sees into the open through.
void add_glass_doors(FloorPlan& plan, double x0, double y0, double x1, double y1, double chance, Random& random) {
  constexpr double kEps = 1e-6;
  const std::size_t count = plan.rooms.size();
  for (std::size_t i = 0; i < count; ++i) {
    const RoomPlan& room = plan.rooms[i];
    if (room.use == RoomUse::kBath || room.use == RoomUse::kHallway || !random.chance(chance)) continue;
    const double width = random.uniform(0.8, 2.0);
    const bool in_x_wall = room.x0 < x0 + kEps || room.x1 > x1 - kEps;
    const bool in_y_wall = room.y0 < y0 + kEps || room.y1 > y1 - kEps;
    if (!in_x_wall && !in_y_wall) continue;
    const double from = in_x_wall ? room.y0 : room.x0, to = in_x_wall ? room.y1 : room.x1;
    if (to - from < width + 0.4) continue;
    const bool is_low = in_x_wall ? room.x1 > x1 - kEps : room.y1 > y1 - kEps;
    const double start = random.uniform(from + 0.2, to - 0.2 - width);
    const int index = static_cast<int>(i);
    plan.doors.push_back(
        {is_low ? index : -1, is_low ? -1 : index, in_x_wall, start, start + width, DoorState::kClosed, true});
  }
}

/// Doors so that every room can be reached from room 0, hallways first, and a few more.
void connect(FloorPlan& plan, double wall, double extra, Random& random) {
  const int count = static_cast<int>(plan.rooms.size());
  std::vector<bool> reached(plan.rooms.size(), false);
  reached[0] = true;
  std::vector<int> order(plan.rooms.size());
  std::iota(order.begin(), order.end(), 0);
  for (bool grown = true; grown;) {
    grown = false;
    for (const int from : order) {
      if (!reached[static_cast<std::size_t>(from)]) continue;
      for (int to = 0; to < count; ++to) {
        if (reached[static_cast<std::size_t>(to)]) continue;
        if (!add_door(plan, from, to, random.uniform(0.72, 0.95), wall, random)) continue;
        reached[static_cast<std::size_t>(to)] = true;
        grown = true;
      }
    }
  }
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (random.chance(extra)) add_door(plan, a, b, random.uniform(0.72, 0.95), wall, random);
    }
  }
}

/// A corner that is cut off the room (chimney, shaft, the neighbour's bathroom), out of the way of every door.
void cut_corner(FloorPlan& plan, std::size_t index, Random& random) {
  const RoomPlan& room = plan.rooms[index];
  const double width = random.uniform(0.4, 0.4 * room.width()), depth = random.uniform(0.4, 0.4 * room.height());
  const bool right = random.chance(0.5), top = random.chance(0.5);
  const double x = right ? room.x1 - 0.5 * width : room.x0 + 0.5 * width,
               y = top ? room.y1 - 0.5 * depth : room.y0 + 0.5 * depth;
  for (const DoorPlan& door : plan.doors) {
    if (door.low != static_cast<int>(index) && door.high != static_cast<int>(index)) continue;
    const double middle = 0.5 * (door.from + door.to),
                 half = 0.5 * (door.to - door.from) + 0.5 * (door.in_x_wall ? depth : width);
    if (std::abs(middle - (door.in_x_wall ? y : x)) < half + 0.3) return;
  }
  plan.pillars.push_back({{x, y, 0.0}, width, depth});
}

}  // namespace

FloorPlan plan_room(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  const double w = random.uniform(2.8, 6.5), h = random.uniform(2.6, 5.5), wall = random.uniform(0.1, 0.2);
  constexpr RoomUse uses[] = {RoomUse::kLiving, RoomUse::kBedroom, RoomUse::kKitchen, RoomUse::kOffice};
  plan.rooms.push_back(inset({0.0, 0.0, w, h}, wall, uses[random.below(4)]));
  // What lies behind its doors: a hallway, and often a neighbour.
  const double hall = random.uniform(1.1, 1.8);
  plan.rooms.push_back(
      inset({random.uniform(-2.5, 0.0), -hall, w + random.uniform(0.0, 2.5), 0.0}, wall, RoomUse::kHallway, false));
  if (random.chance(0.5)) {
    plan.rooms.push_back(inset({w, 0.0, w + random.uniform(2.0, 4.0), h}, wall, uses[random.below(4)], false));
    add_door(plan, 0, 2, random.chance(0.2) ? 1.6 : random.uniform(0.75, 0.95), wall, random);
  }
  add_door(plan, 0, 1, random.uniform(0.75, 0.95), wall, random);
  draw_states(plan, 0.5, 0.2, 0.15, random);
  const RoomPlan& room = plan.rooms[0];
  if (random.chance(0.4)) {
    const double width = std::min(random.uniform(0.8, 2.4), room.width() - 0.5);
    const double start = random.uniform(room.x0 + 0.2, room.x1 - 0.2 - width);
    plan.doors.push_back({0, -1, false, start, start + width, DoorState::kClosed, true});
  }
  if (random.chance(0.4)) cut_corner(plan, 0, random);
  return plan;
}

FloorPlan plan_flat(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  const double w = random.uniform(7.0, 12.0), h = random.uniform(6.0, 9.5), wall = random.uniform(0.1, 0.18);
  std::vector<Cell> cells;
  if (random.chance(0.7)) {
    const double y = h * random.uniform(0.35, 0.55), hall = random.uniform(1.15, 1.7),
                 x = random.chance(0.5) ? w : w * random.uniform(0.6, 0.8);
    cells.push_back({0.0, y, x, y + hall});
    split({0.0, 0.0, w, y}, 2.0, 12.0, cells, random);
    split({0.0, y + hall, w, h}, 2.0, 12.0, cells, random);
    if (x < w) cells.push_back({x, y, w, y + hall});
  } else {
    split({0.0, 0.0, w, h}, 2.2, 13.0, cells, random);
  }
  std::vector<double> areas;
  for (const Cell& cell : cells) areas.push_back(cell.width() * cell.height());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    constexpr RoomUse uses[] = {RoomUse::kBedroom, RoomUse::kKitchen, RoomUse::kLiving, RoomUse::kBedroom,
                                RoomUse::kOffice};
    const double narrow = std::min(cells[i].width(), cells[i].height());
    RoomUse use = uses[random.below(5)];
    if (narrow < 1.8)
      use = RoomUse::kHallway;
    else if (areas[i] < 6.0)
      use = RoomUse::kBath;
    else if (areas[i] > 18.0)
      use = RoomUse::kLiving;
    plan.rooms.push_back(inset(cells[i], wall, use));
  }
  connect(plan, wall, 0.12, random);
  draw_states(plan, 0.6, 0.2, 0.05, random);
  add_glass_doors(plan, 0.5 * wall, 0.5 * wall, w - 0.5 * wall, h - 0.5 * wall, 0.35, random);
  for (std::size_t i = 0; i < plan.rooms.size(); ++i) {
    if (plan.rooms[i].area() > 9.0 && random.chance(0.3)) cut_corner(plan, i, random);
  }
  return plan;
}

FloorPlan plan_office(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  const double wall = random.uniform(0.1, 0.2);
  if (random.chance(0.35)) {
    // One large room, desks and partitions in it, a corridor beside it.
    const double w = random.uniform(7.0, 13.0), h = random.uniform(5.5, 9.0);
    plan.rooms.push_back(inset({0.0, 0.0, w, h}, wall, RoomUse::kOffice));
    plan.rooms.push_back(inset({-2.0, -2.0, w + 2.0, 0.0}, wall, RoomUse::kCorridor));
    add_door(plan, 0, 1, 0.95, wall, random);
    add_door(plan, 0, 1, 0.95, wall, random);
  } else {
    const double length = random.uniform(10.0, 18.0), corridor = random.uniform(1.6, 2.4);
    plan.rooms.push_back(inset({0.0, 0.0, length, corridor}, wall, RoomUse::kCorridor));
    for (const bool upper : {false, true}) {
      const double depth = random.uniform(3.8, 5.5);
      double x = 0.0;
      while (x < length - 1.0) {
        double next = x + random.uniform(2.6, 5.5);
        if (length - next < 2.4) next = length;
        const Cell cell = upper ? Cell{x, corridor, next, corridor + depth} : Cell{x, -depth, next, 0.0};
        plan.rooms.push_back(inset(cell, wall, RoomUse::kOffice));
        x = next;
      }
    }
    const int count = static_cast<int>(plan.rooms.size());
    for (int i = 1; i < count; ++i) {
      add_door(plan, 0, i, random.uniform(0.85, 1.0), wall, random);
      if (i + 1 < count && random.chance(0.2)) add_door(plan, i, i + 1, random.uniform(0.85, 1.0), wall, random);
    }
  }
  draw_states(plan, 0.6, 0.15, 0.15, random);
  return plan;
}

FloorPlan plan_corridor(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  plan.style.pillars = random.uniform(0.2, 0.5);
  const double wall = random.uniform(0.1, 0.25), width = random.uniform(1.4, 2.8), length = random.uniform(12.0, 25.0);
  plan.rooms.push_back(inset({0.0, 0.0, length, width}, wall, RoomUse::kCorridor));
  std::vector<bool> is_branch{false};
  for (const bool upper : {false, true}) {
    double x = 0.0;
    while (x < length - 1.0) {
      const bool branch = random.chance(0.12);
      double next = x + (branch ? random.uniform(1.4, 2.4) : random.uniform(2.2, 5.0));
      if (length - next < 2.0) next = length;
      const double depth = branch ? random.uniform(4.0, 9.0) : random.uniform(2.5, 5.0);
      const Cell cell = upper ? Cell{x, width, next, width + depth} : Cell{x, -depth, next, 0.0};
      constexpr RoomUse uses[] = {RoomUse::kOffice, RoomUse::kOffice, RoomUse::kBedroom, RoomUse::kKitchen};
      plan.rooms.push_back(inset(cell, wall, branch ? RoomUse::kCorridor : uses[random.below(4)], false));
      is_branch.push_back(branch);
      x = next;
    }
  }
  for (int i = 1; i < static_cast<int>(plan.rooms.size()); ++i) {
    const RoomPlan& room = plan.rooms[static_cast<std::size_t>(i)];
    const bool branch = is_branch[static_cast<std::size_t>(i)];
    add_door(plan, 0, i, branch ? room.width() - 0.25 : random.uniform(0.8, 1.0), wall, random);
  }
  draw_states(plan, 0.4, 0.2, 0.35, random);
  for (DoorPlan& door : plan.doors) {
    if (is_branch[static_cast<std::size_t>(std::max(door.low, door.high))] ||
        is_branch[static_cast<std::size_t>(std::min(door.low, door.high))]) {
      door.state = DoorState::kNoLeaf;
    }
  }
  return plan;
}

FloorPlan plan_hall(Random& random) {
  FloorPlan plan;
  plan.style = draw_style(random);
  plan.style.unevenness_m = random.uniform(0.005, 0.02);
  plan.style.clutter = random.uniform(0.7, 1.5);
  const double w = random.uniform(20.0, 38.0), h = random.uniform(14.0, 28.0), wall = 0.3;
  plan.rooms.push_back(inset({0.0, 0.0, w, h}, wall, RoomUse::kHall));
  plan.rooms.push_back(
      inset({w, 0.0, w + random.uniform(5.0, 12.0), h * random.uniform(0.5, 1.0)}, wall, RoomUse::kHall, false));
  add_door(plan, 0, 1, random.uniform(2.5, 4.0), wall, random);
  plan.rooms.push_back(
      inset({0.0, -random.uniform(3.0, 6.0), w * random.uniform(0.3, 0.8), 0.0}, wall, RoomUse::kOffice, false));
  add_door(plan, 0, 2, random.uniform(0.9, 2.0), wall, random);
  draw_states(plan, 0.4, 0.0, 0.2, random);
  if (random.chance(0.75)) {
    // Rows of pillars, evenly spaced as builders do it: the hall repeats itself.
    const double pitch = random.uniform(4.0, 8.0), size = random.uniform(0.25, 0.8);
    const int rows = h > 20.0 ? 2 : 1;
    for (int r = 1; r <= rows; ++r) {
      for (double x = pitch; x < w - 1.0; x += pitch)
        plan.pillars.push_back({{x, h * r / (rows + 1), 0.0}, size, size});
    }
  }
  return plan;
}

}  // namespace phasescan::sim
