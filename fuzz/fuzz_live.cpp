// What comes over the line from a sensor: the first byte tells the model, the second how large the pieces are.
#include <algorithm>
#include <cstdlib>

#include "phasescan/live/turns.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace phasescan;
  if (size < 2) return 0;
  const auto models = live::sensor_models();
  const live::SensorModel& model = models[data[0] % models.size()];
  const auto decoder = live::make_decoder(model, live::bytes_per_second(model));
  live::TurnAssembler turns;
  live::Decoded decoded;
  std::vector<Scan> scans;
  const std::size_t piece = 1 + data[1];
  Stamp now = 0;
  for (std::size_t at = 2; at < size; at += piece) {
    decoded.clear();
    decoder->feed({data + at, std::min(piece, size - at)}, now += 1'000'000, decoded);
    turns.add(decoded.beams, decoder->range_min(), decoder->range_max(), scans);
  }
  // A beam takes a byte of some packet at least, and each lost one stands between two that are there.
  if (decoded.beams.size() > 200 * (size + 100)) std::abort();
  return 0;
}
