/// Compares a view with a scan at all turns.
#pragma once

#include <cstddef>
#include <cstdint>

#include "localize/view_table.hpp"

namespace phasescan {

/// Differences of bytes above this count as this: what differs more is another thing, however far away.
inline constexpr std::uint8_t kMostDifference = 20;

/// cost[t] = sum over kViewHalf directions of min(|min(view, reach) - rotated[t]|, kMostDifference), known ones alone.
/// @param rotated, known  `turns` rows of kViewHalf bytes
void compare_at_all_turns(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                          const std::uint8_t* known, std::size_t turns, std::uint16_t* cost);

}  // namespace phasescan
