#include "sim/world_kinds.hpp"

#include <stdexcept>

#include "sim/layouts.hpp"

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<sim::WorldKind>() {
  static constexpr std::string_view names[] = {"room", "office",     "corridor",      "flat",
                                               "hall", "empty-room", "bare-corridor", "building"};
  return names;
}

}  // namespace phasescan

namespace phasescan::sim {
namespace {

/// A rectangle of bare walls, exactly symmetric, centred at the origin.
World bare_rectangle(double width, double height) {
  World world;
  const double w = 0.5 * width, h = 0.5 * height;
  const Polygon outline{{-w, -h}, {w, -h}, {w, h}, {-w, h}, {-w, -h}};
  world.shape.add_line(outline);
  world.rooms.push_back({outline.begin(), outline.end() - 1});
  return world;
}

World bare_corridor(double width) {
  constexpr double kHalf_m = 60.0, kStand_m = 5.0;
  World world;
  const double h = 0.5 * width;
  world.shape.add_line({{-kHalf_m, -h}, {kHalf_m, -h}});
  world.shape.add_line({{-kHalf_m, h}, {kHalf_m, h}});
  world.rooms.push_back({{-kStand_m, -h}, {kStand_m, -h}, {kStand_m, h}, {-kStand_m, h}});
  return world;
}

}  // namespace

World make_world(WorldKind kind, std::uint64_t seed) {
  Random random(Random::derive(seed, static_cast<std::uint64_t>(kind)));
  World world;
  switch (kind) {
    case WorldKind::kRoom:
      world = build_world(plan_room(random), random);
      break;
    case WorldKind::kOffice:
      world = build_world(plan_office(random), random);
      break;
    case WorldKind::kCorridor:
      world = build_world(plan_corridor(random), random);
      break;
    case WorldKind::kFlat:
      world = build_world(plan_flat(random), random);
      break;
    case WorldKind::kHall:
      world = build_world(plan_hall(random), random);
      break;
    case WorldKind::kEmptyRoom: {
      const double width = random.uniform(3.0, 6.0);
      world = bare_rectangle(width, random.chance(0.25) ? width : random.uniform(2.4, 5.0));
      break;
    }
    case WorldKind::kBareCorridor:
      world = bare_corridor(random.uniform(1.2, 2.8));
      break;
    case WorldKind::kBuilding:
      world = build_world(plan_building(random), random);
      break;
  }
  world.name = std::string(to_string(kind)) + "-" + std::to_string(seed);
  return world;
}

}  // namespace phasescan::sim
