// Numbers of the three low-cost text formats, for the readers and for telling the formats apart.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace phasescan {

inline constexpr std::size_t kSlambotNumbers = 3 + 360;
inline constexpr std::size_t kBreezyHead = 24;
inline constexpr std::size_t kBreezyBeams = 682;
inline constexpr std::size_t kPolarHead = 3;
inline constexpr std::size_t kFewestPolarBeams = 64;

/// Difference of two counters of 16 bits.
inline int wrapped_difference(double now, double before) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(static_cast<std::int64_t>(now)) -
                                   static_cast<std::uint16_t>(static_cast<std::int64_t>(before)));
}

inline bool is_integer_up_to(double value, double most) {
  return std::abs(value) <= most && value == std::floor(value);
}

}  // namespace phasescan
