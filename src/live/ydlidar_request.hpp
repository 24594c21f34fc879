// YDLIDAR's requests: A5 and one byte.
#pragma once

#include <cstdint>

namespace phasescan::live {

inline constexpr std::uint8_t kYdlidarStart[] = {0xA5, 0x60}, kYdlidarStop[] = {0xA5, 0x65},
                              kYdlidarInfo[] = {0xA5, 0x90};

}  // namespace phasescan::live
