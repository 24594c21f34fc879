/// Compares a view with a scan: at all coarse turns with a few directions, or at one turn with all.
#pragma once

#include <cstddef>
#include <cstdint>

#include "localize/view_table.hpp"

namespace phasescan {

/// Differences of bytes above this count as this: what differs more is another thing, however far away.
inline constexpr std::uint8_t kMostDifference = 20;

/// cost[t] = sum over the first kCoarseDirections bytes of the view of min(|min(view[c], reach) - rotated[c][t]|,
/// most[c][t]).
/// @param rotated, most  a row of kCoarseTurns bytes for each direction; most is 0 where the scan knows nothing
/// @param cost           kCoarseTurns numbers
/// @return the least cost
std::uint16_t compare_at_coarse_turns(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                                      const std::uint8_t* most, std::uint16_t* cost);

/// Sum over kViewDirections bytes of min(|min(view[d], reach) - rotated[d]|, most[d]).
std::uint16_t compare_at_turn(const std::uint8_t* view, std::uint8_t reach, const std::uint8_t* rotated,
                              const std::uint8_t* most);

}  // namespace phasescan
