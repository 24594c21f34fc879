#include "phasescan/live/decoder.hpp"

int main() {
  const auto decoder = phasescan::live::make_decoder(*phasescan::live::find_sensor("ld06"), 23040.0);
  phasescan::live::Decoded decoded;
  const std::uint8_t byte = 0x54;
  decoder->feed({&byte, 1}, 0, decoded);
  return decoded.beams.empty() ? 0 : 1;
}
