/// Which things stand in which room, and where they fit.
#include <algorithm>
#include <cmath>
#include <span>

#include "sim/floor_plan.hpp"
#include "sim/passage.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// A thing of a room: how many to expect at clutter 1 (per 10 m^2 where `by_area`), and whether its back is at a wall.
struct Habit {
  ItemKind kind;
  double expected;
  bool by_area;
  bool at_wall;
};

std::span<const Habit> habits(RoomUse use) {
  using enum ItemKind;
  static constexpr Habit living[] = {{kSofa, 1.1, false, true},     {kTable, 0.9, false, false},
                                     {kCupboard, 1.2, true, true},  {kShelf, 0.9, true, true},
                                     {kRadiator, 0.8, false, true}, {kCurtain, 1.2, false, true},
                                     {kPlant, 1.0, true, true},     {kClutter, 2.5, true, true},
                                     {kClutter, 0.6, true, false},  {kBin, 0.3, false, true}};
  static constexpr Habit bedroom[] = {
      {kBed, 1.1, false, true},    {kCupboard, 1.6, true, true},  {kDesk, 0.5, false, true},
      {kShelf, 0.5, true, true},   {kRadiator, 0.8, false, true}, {kCurtain, 1.0, false, true},
      {kClutter, 2.5, true, true}, {kClutter, 0.6, true, false},  {kOfficeChair, 0.4, false, false}};
  static constexpr Habit kitchen[] = {{kCupboard, 3.5, true, true},
                                      {kTable, 0.9, false, false},
                                      {kBin, 0.9, false, true},
                                      {kRadiator, 0.5, false, true},
                                      {kClutter, 1.6, true, true}};
  static constexpr Habit bath[] = {{kBath, 2.4, false, true}, {kBin, 0.7, false, true}, {kClutter, 1.0, false, true}};
  static constexpr Habit hallway[] = {
      {kCupboard, 0.8, true, true}, {kClutter, 2.5, true, true}, {kShelf, 0.4, true, true}, {kPlant, 0.3, false, true}};
  static constexpr Habit office[] = {
      {kDesk, 1.8, true, true},        {kDesk, 0.4, true, false},     {kOfficeChair, 1.5, true, false},
      {kCupboard, 0.9, true, true},    {kShelf, 0.8, true, true},     {kBin, 0.7, true, true},
      {kPartition, 0.25, true, false}, {kRadiator, 0.8, false, true}, {kPlant, 0.3, true, true},
      {kClutter, 1.4, true, true},     {kTable, 0.12, true, false}};
  static constexpr Habit corridor[] = {
      {kCupboard, 0.7, true, true}, {kShelf, 0.35, true, true},  {kBin, 0.5, true, true}, {kRadiator, 0.4, true, true},
      {kPlant, 0.25, true, true},   {kClutter, 1.1, true, true}, {kSofa, 0.1, true, true}};
  static constexpr Habit hall[] = {{kMachine, 0.10, true, false}, {kPallet, 0.15, true, false},
                                   {kRack, 0.06, true, false},    {kRack, 0.05, true, true},
                                   {kCupboard, 0.06, true, true}, {kPallet, 0.1, true, true},
                                   {kClutter, 0.15, true, true},  {kBin, 0.04, true, false}};
  switch (use) {
    case RoomUse::kLiving:
      return living;
    case RoomUse::kBedroom:
      return bedroom;
    case RoomUse::kKitchen:
      return kitchen;
    case RoomUse::kBath:
      return bath;
    case RoomUse::kHallway:
      return hallway;
    case RoomUse::kOffice:
      return office;
    case RoomUse::kCorridor:
      return corridor;
    case RoomUse::kHall:
      return hall;
    case RoomUse::kEmpty:
      break;
  }
  return {};
}

/// A place for the item: its back along a wall, a little crooked, or anywhere at any angle.
Pose2 draw_place(const RoomPlan& room, const Item& item, bool at_wall, Random& random) {
  if (!at_wall) {
    const double turn = random.chance(0.6) ? 0.5 * kPi * static_cast<double>(random.below(4)) + random.normal(0.0, 0.05)
                                           : random.uniform(-kPi, kPi);
    return {random.uniform(room.x0, room.x1), random.uniform(room.y0, room.y1), turn};
  }
  const double off = 0.5 * item.depth + (random.chance(0.6) ? random.uniform(0.0, 0.03) : random.uniform(0.03, 0.15));
  const double crooked = random.chance(0.85) ? random.normal(0.0, 0.015) : random.normal(0.0, 0.2);
  const bool along_x = random.chance(room.width() / (room.width() + room.height())), first = random.chance(0.5);
  if (along_x) {
    const double x = random.uniform(room.x0 + 0.5 * item.width, room.x1 - 0.5 * item.width);
    return first ? Pose2{x, room.y0 + off, crooked} : Pose2{x, room.y1 - off, wrap_angle(kPi + crooked)};
  }
  const double y = random.uniform(room.y0 + 0.5 * item.width, room.y1 - 0.5 * item.width);
  return first ? Pose2{room.x0 + off, y, -0.5 * kPi + crooked} : Pose2{room.x1 - off, y, 0.5 * kPi + crooked};
}

bool fits(const RoomPlan& room, const Footprint& place, const std::vector<Footprint>& taken) {
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      const Vector2d corner = place.T_room_item * Vector2d(sx * place.width, sy * place.depth);
      constexpr double kPlay_m = 0.03;
      if (corner.x() < room.x0 - kPlay_m || corner.x() > room.x1 + kPlay_m || corner.y() < room.y0 - kPlay_m ||
          corner.y() > room.y1 + kPlay_m) {
        return false;
      }
    }
  }
  return std::none_of(taken.begin(), taken.end(),
                      [&](const Footprint& other) { return footprints_overlap(place, other, 0.01); });
}

}  // namespace

void furnish(const RoomPlan& room, const std::vector<Vector2d>& entrances, double clutter,
             std::vector<Footprint>& taken, World& world, Random& random) {
  if (clutter <= 0.0) return;
  PassageGrid passage(room, entrances);
  for (const Habit& habit : habits(room.use)) {
    const double expected = clutter * habit.expected * (habit.by_area ? room.area() / 10.0 : 1.0);
    const double drawn = expected * random.uniform(0.5, 1.5);
    const int count = static_cast<int>(drawn) + (random.chance(drawn - std::floor(drawn)) ? 1 : 0);
    for (int i = 0; i < count; ++i) {
      const Item item = make_item(habit.kind, random);
      constexpr int kTries = 12;
      for (int k = 0; k < kTries; ++k) {
        const Footprint place{draw_place(room, item, habit.at_wall, random), item.width, item.depth};
        if (!fits(room, place, taken) || !passage.try_block(place)) continue;
        const MovablePart before = end_of_shape(world);
        world.shape.append(item.shape, place.T_room_item);
        note_part(MovablePart::Kind::kFurniture, before, world);
        taken.push_back(place);
        break;
      }
    }
  }
}

}  // namespace phasescan::sim
