/// Seeded worlds by kind: each seed is another building.
#pragma once

#include <cstdint>

#include "phasescan/core/options.hpp"
#include "sim/world.hpp"

namespace phasescan::sim {

enum class WorldKind {
  kRoom,          ///< one furnished room with its doors, what lies behind them in view
  kOffice,        ///< office rooms along a corridor, or a large one with partitions
  kCorridor,      ///< 12-25 m with doors open, ajar and closed; the sensor stays in it
  kFlat,          ///< 4-7 rooms
  kHall,          ///< 20-38 m, pillars, machines, racks
  kEmptyRoom,     ///< a bare rectangle: looks the same after half a turn
  kBareCorridor,  ///< two bare parallel walls, longer than any sensor here sees
  kBuilding,      ///< 20-60 rooms in blocks between corridors that form loops
};

/// Makes the building of a kind and seed: the same surfaces for the same seed, always.
World make_world(WorldKind kind, std::uint64_t seed);

}  // namespace phasescan::sim

namespace phasescan {
template <>
std::span<const std::string_view> enum_names<sim::WorldKind>();
}  // namespace phasescan
