// SICK's frames around telegrams.
#pragma once

#include <cstdint>

namespace phasescan::live::sick {

inline constexpr std::uint8_t kStx = 0x02, kEtx = 0x03;
/// Types of a Reply: a telegram of text, and one of a sensor that is set to the binary form (CoLa B).
inline constexpr int kTelegram = 1, kBinary = 2;
inline constexpr char kStart[] = "\x02sEN LMDscandata 1\x03";
inline constexpr char kStopSending[] = "\x02sEN LMDscandata 0\x03";

}  // namespace phasescan::live::sick
