/// Floor plans: rectangular rooms in a common frame, doors between them, and how they become surfaces.
#pragma once

#include <vector>

#include "core/random.hpp"
#include "sim/world.hpp"
#include "sim/furniture.hpp"

namespace phasescan::sim {

enum class RoomUse { kLiving, kBedroom, kKitchen, kBath, kHallway, kOffice, kCorridor, kHall, kEmpty };

/// A room's inner outline, walls excluded [m].
struct RoomPlan {
  double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
  RoomUse use = RoomUse::kLiving;
  bool stand_here = true;  ///< false: only looked into

  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  double area() const { return width() * height(); }
};

enum class DoorState { kOpen, kAjar, kClosed, kNoLeaf };

/// A gap in the wall between two rooms, or to the outside.
struct DoorPlan {
  int low = -1;           ///< the room at smaller coordinates, -1 = outside
  int high = -1;          ///< the room at larger coordinates, -1 = outside
  bool in_x_wall = true;  ///< the wall runs along y at constant x; false: along x at constant y
  double from = 0.0;      ///< along the wall [m]
  double to = 0.0;
  DoorState state = DoorState::kOpen;
  bool glazed = false;
};

/// How untidy the building and what stands in it are.
struct PlanStyle {
  double unevenness_m = 0.01;  ///< of the walls
  double warp_m = 0.03;        ///< smooth bend of the whole building
  double shear = 0.01;         ///< out of square
  double clutter = 1.0;        ///< furniture and clutter, 0 = bare
  double pillars = 0.3;        ///< pilasters a wall piece, probability
};

struct FloorPlan {
  std::vector<RoomPlan> rooms;
  std::vector<DoorPlan> doors;
  std::vector<Footprint>
      pillars;  ///< solid from floor to ceiling: pillars, chimneys, corners that are not part of a room
  PlanStyle style;
};

/// Walls, doors and furniture of a plan.
World build_world(const FloorPlan& plan, Random& random);

/// Furniture of one room that leaves a way between all its entrances (points just inside its doors); `taken` are
/// footprints to keep clear of, and grows.
void furnish(const RoomPlan& room, const std::vector<Eigen::Vector2d>& entrances, double clutter,
             std::vector<Footprint>& taken, World& world, Random& random);

/// Adds what the shape has grown by since `before` as one thing that can be moved.
void note_part(MovablePart::Kind kind, const MovablePart& before, World& world);
/// Where the shape ends now.
MovablePart end_of_shape(const World& world);

/// Draws an opening of `width` in the wall that two cells of a tiling share, with `margin` to its ends; none if it is
/// too short. Rooms are the cells inset by half the wall.
bool add_door(FloorPlan& plan, int room_a, int room_b, double width, double wall, Random& random);

}  // namespace phasescan::sim
