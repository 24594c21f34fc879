// What a Foxglove client says: frames of a kind byte, a length of two bytes, and so many bytes.
#include <algorithm>
#include <cstdlib>

#include "foxglove/client.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace phasescan::foxglove;
  Client client;
  for (std::size_t at = 0; at + 3 <= size;) {
    const bool binary = (data[at] & 1) != 0;
    const std::size_t length = std::min<std::size_t>(data[at + 1] | data[at + 2] << 8, size - at - 3);
    const std::span<const std::uint8_t> frame(data + at + 3, length);
    const Outcome outcome =
        binary ? client.take_binary(frame) : client.take_text({reinterpret_cast<const char*>(frame.data()), length}, 8);
    if (outcome.pose && (!outcome.pose->pose.is_finite() || !outcome.pose->covariance.allFinite())) std::abort();
    for (const auto& [level, text] : outcome.statuses) {
      if (status(level, text).size() < 20) std::abort();
    }
    for (const auto& [id, channel] : outcome.subscribed) {
      if (channel == 0 || channel > 8) std::abort();
    }
    at += 3 + length;
  }
  if (client.subscriptions() > 256) std::abort();
  return 0;
}
