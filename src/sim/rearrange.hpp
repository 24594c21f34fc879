/// The same building later: furniture moved or gone, doors at other angles.
#pragma once

#include <cstdint>

#include "sim/world.hpp"

namespace phasescan::sim {

struct RearrangeOptions {
  double furniture_share = 0.3;  ///< of the things, moved within their room or taken away
  double doors_share = 0.3;      ///< of the leaves, opened, turned or shut
};

/// Walls, rooms and doorways stay. The same for the same world, options and seed.
World rearrange(const World& world, const RearrangeOptions& options, std::uint64_t seed);

}  // namespace phasescan::sim
