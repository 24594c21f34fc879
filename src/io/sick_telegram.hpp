// One telegram LMDscandata of a SICK laser scanner (CoLa A), word by word.
//
//   sRA LMDscandata version device serial status(2) telegrams scans start_us sent_us inputs(2) outputs(2) layer
//   frequency rate encoders [position speed].. channels16 {name scale offset start step count values..} ..
//   channels8 {..} position name comment time [year month day hour minute second us] ..
//
// Numbers are hexadecimal; a scale is the bits of a float, the start angle 1/10000 deg, ranges are mm.
// Source: SICK, "Telegrams for configuring and operating LMS1xx, LMS5xx, TiM2xx, TiM5xx, TiM7xx, MRS1000, MRS6000".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Why a telegram cannot be read.
struct BadTelegram {
  std::string reason;
};

struct SickTelegram {
  std::uint32_t started_us = 0;  ///< of the sensor's clock, of 32 bits
  std::uint32_t layer = 0;       ///< 0: in the plane
  double turns_hz = 0.0;
  Scan scan;  ///< without a stamp; intensities where they are told
};

/// @param words     of the telegram, split at blanks, without STX and ETX
/// @param zero_deg  added to directions: most models call what is ahead 90 degrees
/// @throws BadTelegram
SickTelegram read_sick_telegram(const std::vector<std::string_view>& words, double zero_deg);

}  // namespace phasescan
