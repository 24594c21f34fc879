#include "sim/floor_plan.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// One side of a room as a line from a to b with the room on its left.
struct Side {
  Vector2d a, b;
  std::vector<std::pair<double, double>> openings;  ///< along a to b [m]
};

/// A wall piece between openings: slightly uneven, now and then a pilaster or a pipe.
void add_wall(const Vector2d& a, const Vector2d& b, const PlanStyle& style, Shape& shape, Random& random) {
  const double length = (b - a).norm();
  if (length < 1e-6) return;
  const Vector2d along = (b - a) / length, inward(-along.y(), along.x());
  const auto at = [&](double s, double offset) -> Vector2d { return a + s * along + offset * inward; };
  Polygon line{a};
  double s = 0.0;
  while (length - s > 0.8) {
    s += std::min(random.uniform(0.4, 1.6), length - s - 0.2);
    const double offset = std::clamp(random.normal(0.0, style.unevenness_m), -0.04, 0.04);
    line.push_back(at(s, offset));
    if (random.chance(style.pillars) && length - s > 1.0) {
      const double width = random.uniform(0.1, 0.6), depth = random.uniform(0.04, 0.25);
      line.push_back(at(s, depth));
      line.push_back(at(s + width, depth));
      line.push_back(at(s + width, offset));
      s += width;
    } else if (random.chance(0.3 * style.pillars)) {
      shape.add_disc(at(s, random.uniform(0.05, 0.1)), random.uniform(0.02, 0.06));
    }
  }
  line.push_back(b);
  shape.add_line(line);
}

/// Jambs, leaf and glazing of a door whose gap runs from p to q on the low side; `across` leads to the high side.
void add_door_parts(const DoorPlan& door, const Vector2d& p, const Vector2d& q, const Vector2d& across, World& world,
                    Random& random) {
  Shape& shape = world.shape;
  shape.add_line({p, p + across});
  shape.add_line({q, q + across});
  if (door.state == DoorState::kNoLeaf) return;
  const double width = (q - p).norm(), depth = random.uniform(0.1, 0.9);
  const Material material = door.glazed ? Material::kGlass : Material::kMatt;
  const MovablePart before = end_of_shape(world);
  if (door.state == DoorState::kClosed) {
    shape.add_line({p + depth * across, q + depth * across}, material);
    note_part(MovablePart::Kind::kDoorLeaf, before, world);
    return;
  }
  // The leaf hangs at one jamb and opens to one side, 4 cm thick.
  const bool at_p = random.chance(0.5), to_high = random.chance(0.5);
  const Vector2d hinge = (at_p ? p : q) + (to_high ? across : Vector2d(0.0, 0.0));
  const Vector2d closed = (at_p ? q - p : p - q) / width;
  const Vector2d out = (to_high ? across : Vector2d(-across)).normalized();
  const double angle = door.state == DoorState::kAjar ? random.uniform(0.35, 1.25) : random.uniform(1.4, 2.4);
  const Vector2d leaf = std::cos(angle) * closed + std::sin(angle) * out;
  const Vector2d thick(-0.02 * leaf.y(), 0.02 * leaf.x());
  const Vector2d tip = hinge + 0.96 * width * leaf;
  shape.add_solid({hinge - thick, tip - thick, tip + thick, hinge + thick}, material);
  note_part(MovablePart::Kind::kDoorLeaf, before, world);
}

}  // namespace

MovablePart end_of_shape(const World& world) {
  const Shape& s = world.shape;
  const std::size_t segments = s.segments.size(), discs = s.discs.size(), solids = s.solids.size();
  return {MovablePart::Kind::kFurniture, segments, segments, discs, discs, solids, solids};
}

void note_part(MovablePart::Kind kind, const MovablePart& before, World& world) {
  MovablePart part = before;
  const MovablePart end = end_of_shape(world);
  part.kind = kind;
  part.last_segment = end.last_segment, part.last_disc = end.last_disc, part.last_solid = end.last_solid;
  world.parts.push_back(part);
}

bool add_door(FloorPlan& plan, int room_a, int room_b, double width, double wall, Random& random) {
  const auto find = [&](int low, int high, bool x_wall) {
    const RoomPlan &l = plan.rooms[static_cast<std::size_t>(low)], &h = plan.rooms[static_cast<std::size_t>(high)];
    const double gap = x_wall ? h.x0 - l.x1 : h.y0 - l.y1;
    if (std::abs(gap - wall) > 1e-6) return false;
    const double from = x_wall ? std::max(l.y0, h.y0) : std::max(l.x0, h.x0);
    const double to = x_wall ? std::min(l.y1, h.y1) : std::min(l.x1, h.x1);
    constexpr double kMargin = 0.12;
    if (to - from < width + 2.0 * kMargin) return false;
    const double start = random.uniform(from + kMargin, to - kMargin - width);
    for (const DoorPlan& other : plan.doors) {
      const bool same_wall = other.in_x_wall == x_wall && (other.low == low || other.high == high);
      if (same_wall && other.from < start + width + 0.1 && start < other.to + 0.1) return false;
    }
    plan.doors.push_back({low, high, x_wall, start, start + width, DoorState::kOpen, false});
    return true;
  };
  return find(room_a, room_b, true) || find(room_b, room_a, true) || find(room_a, room_b, false) ||
         find(room_b, room_a, false);
}

World build_world(const FloorPlan& plan, Random& random) {
  World world;
  std::vector<Footprint> keep_clear;
  std::vector<std::vector<Vector2d>> entrances(plan.rooms.size());
  for (std::size_t r = 0; r < plan.rooms.size(); ++r) {
    const RoomPlan& room = plan.rooms[r];
    Side sides[4] = {{{room.x0, room.y0}, {room.x1, room.y0}, {}},
                     {{room.x1, room.y0}, {room.x1, room.y1}, {}},
                     {{room.x1, room.y1}, {room.x0, room.y1}, {}},
                     {{room.x0, room.y1}, {room.x0, room.y0}, {}}};
    for (const DoorPlan& door : plan.doors) {
      const bool is_low = door.low == static_cast<int>(r), is_high = door.high == static_cast<int>(r);
      if (!is_low && !is_high) continue;
      if (door.in_x_wall) {
        if (is_low)
          sides[1].openings.emplace_back(door.from - room.y0, door.to - room.y0);
        else
          sides[3].openings.emplace_back(room.y1 - door.to, room.y1 - door.from);
      } else {
        if (is_low)
          sides[2].openings.emplace_back(room.x1 - door.to, room.x1 - door.from);
        else
          sides[0].openings.emplace_back(door.from - room.x0, door.to - room.x0);
      }
      // Nothing stands in front of a door.
      const double middle = 0.5 * (door.from + door.to), width = door.to - door.from + 0.1,
                   deep = std::min(1.8, 2.0 * width);
      const Vector2d at =
          door.in_x_wall ? Vector2d(is_low ? room.x1 : room.x0, middle) : Vector2d(middle, is_low ? room.y1 : room.y0);
      constexpr double kInside_m = 0.45;
      const double inwards = is_low ? -kInside_m : kInside_m;
      if (door.low >= 0 && door.high >= 0)
        entrances[r].push_back(at + (door.in_x_wall ? Vector2d(inwards, 0.0) : Vector2d(0.0, inwards)));
      keep_clear.push_back({{at.x(), at.y(), 0.0}, door.in_x_wall ? deep : width, door.in_x_wall ? width : deep});
    }
    for (Side& side : sides) {
      std::sort(side.openings.begin(), side.openings.end());
      const Vector2d along = (side.b - side.a).normalized();
      double s = 0.0;
      for (const auto& [from, to] : side.openings) {
        add_wall(side.a + s * along, side.a + from * along, plan.style, world.shape, random);
        s = to;
      }
      add_wall(side.a + s * along, side.b, plan.style, world.shape, random);
    }
    if (room.stand_here)
      world.rooms.push_back({{room.x0, room.y0}, {room.x1, room.y0}, {room.x1, room.y1}, {room.x0, room.y1}});
  }
  for (const DoorPlan& door : plan.doors) {
    const RoomPlan* low = door.low >= 0 ? &plan.rooms[static_cast<std::size_t>(door.low)] : nullptr;
    const RoomPlan* high = door.high >= 0 ? &plan.rooms[static_cast<std::size_t>(door.high)] : nullptr;
    constexpr double kOuterWall_m = 0.3;
    double near = 0.0, far = 0.0;
    if (door.in_x_wall) {
      near = low ? low->x1 : high->x0 - kOuterWall_m;
      far = high ? high->x0 : near + kOuterWall_m;
    } else {
      near = low ? low->y1 : high->y0 - kOuterWall_m;
      far = high ? high->y0 : near + kOuterWall_m;
    }
    const Vector2d p = door.in_x_wall ? Vector2d(near, door.from) : Vector2d(door.from, near);
    const Vector2d q = door.in_x_wall ? Vector2d(near, door.to) : Vector2d(door.to, near);
    const Vector2d across = door.in_x_wall ? Vector2d(far - near, 0.0) : Vector2d(0.0, far - near);
    add_door_parts(door, p, q, across, world, random);
    if (low && high && door.state != DoorState::kClosed) world.doors.push_back({p + 0.5 * across, q + 0.5 * across});
  }
  for (const Footprint& pillar : plan.pillars) {
    Shape box;
    box.add_box({0.0, 0.0}, pillar.width, pillar.depth);
    world.shape.append(box, pillar.T_room_item);
    keep_clear.push_back(pillar);
  }
  for (std::size_t r = 0; r < plan.rooms.size(); ++r) {
    furnish(plan.rooms[r], entrances[r], plan.style.clutter, keep_clear, world, random);
  }

  // Nothing built is square: shear, and a smooth bend of a few centimetres over metres.
  const double shear = random.normal(0.0, plan.style.shear), wave_x = random.uniform(0.3, 0.9),
               wave_y = random.uniform(0.3, 0.9);
  const double phase_x = random.uniform(0.0, kTwoPi), phase_y = random.uniform(0.0, kTwoPi), bend = plan.style.warp_m;
  const auto warp = [&](Vector2d& p) {
    p += Vector2d(shear * p.y() + bend * std::sin(wave_x * p.y() + phase_x), bend * std::sin(wave_y * p.x() + phase_y));
  };
  for (Segment& s : world.shape.segments) {
    warp(s.a);
    warp(s.b);
  }
  for (Disc& d : world.shape.discs) warp(d.center);
  for (Polygon& solid : world.shape.solids) {
    for (Vector2d& p : solid) warp(p);
  }
  for (Polygon& room : world.rooms) {
    for (Vector2d& p : room) warp(p);
  }
  for (Doorway& door : world.doors) {
    warp(door.a);
    warp(door.b);
  }
  return world;
}

}  // namespace phasescan::sim
