// Bytes written by hand, and what a decoder makes of them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/live/decoder.hpp"

namespace phasescan::live::testing {

/// "AA 55 01": blanks do not count; "75x00" repeats a byte.
inline std::vector<std::uint8_t> from_hex(std::string_view text) {
  std::vector<std::uint8_t> bytes;
  const auto digit = [](char c) { return static_cast<std::uint8_t>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10); };
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    std::size_t repeat = 1;
    const std::size_t x = text.find('x', i), blank = text.find(' ', i);
    if (x != std::string_view::npos && (blank == std::string_view::npos || x < blank)) {
      repeat = static_cast<std::size_t>(std::stoul(std::string(text.substr(i, x - i))));
      i = x + 1;
    }
    bytes.insert(bytes.end(), repeat, static_cast<std::uint8_t>(digit(text[i]) << 4 | digit(text[i + 1])));
    i += 2;
  }
  return bytes;
}

inline std::unique_ptr<Decoder> decoder_of(std::string_view sensor) {
  const SensorModel& model = *find_sensor(sensor);
  return make_decoder(model, bytes_per_second(model));
}

template <class Bytes>
Decoded decode(Decoder& decoder, const Bytes& bytes, Stamp arrival = 1'000'000'000) {
  Decoded out;
  decoder.feed({reinterpret_cast<const std::uint8_t*>(std::data(bytes)), std::size(bytes)}, arrival, out);
  return out;
}

/// How far the sensor's head had turned, by the direction: clockwise from ahead [deg], in [0, 360).
inline double clockwise_deg(const Beam& beam) {
  return rad_to_deg(wrap_positive(-beam.angle));
}
inline double counter_clockwise_deg(const Beam& beam) {
  return rad_to_deg(wrap_positive(beam.angle));
}
inline double mm(const Beam& beam) {
  return 1e3 * static_cast<double>(beam.range_m);
}

}  // namespace phasescan::live::testing
