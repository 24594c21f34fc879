// Packets of sensors that send one way, and of YDLIDAR. What is in them: the decoders' files.
#include "live/encode.hpp"

#include <algorithm>
#include <cmath>

#include "live/checks.hpp"

namespace phasescan::live {
namespace {

std::uint16_t word_of(double value, double most = 65535.0) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, most)));
}
void put(ByteString& bytes, std::uint16_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word));
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
}
void put_big(ByteString& bytes, std::uint16_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word));
}
std::uint8_t byte_of(int value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}
/// In [0, 360).
double turn_of(double deg) {
  const double on = std::fmod(deg, 360.0);
  return on < 0.0 ? on + 360.0 : on;
}

}  // namespace

ByteString ld06_packet(double deg_per_s, double start_deg, double end_deg, WireSamples samples, std::uint32_t ms) {
  ByteString bytes = {0x54, 0x2C};
  put(bytes, word_of(deg_per_s));
  put(bytes, word_of(100.0 * turn_of(start_deg)));
  for (const WireSample& sample : samples) {
    put(bytes, word_of(sample.mm));
    bytes.push_back(byte_of(sample.signal));
  }
  put(bytes, word_of(100.0 * turn_of(end_deg)));
  put(bytes, static_cast<std::uint16_t>(ms % 30000));
  bytes.push_back(crc8_4d(bytes));
  return bytes;
}

ByteString xv11_packet(int index, double rpm, WireSamples samples) {
  ByteString bytes = {0xFA, static_cast<std::uint8_t>(0xA0 + index)};
  put(bytes, word_of(64.0 * rpm));
  for (const WireSample& sample : samples) {
    put(bytes, sample.mm > 0.0 ? word_of(sample.mm, 0x3FFF) : std::uint16_t{0x8035});  // 35: no return
    put(bytes, word_of(sample.signal));
  }
  put(bytes, folded_sum(bytes));
  return bytes;
}

ByteString lds01_packet(int index, double rpm, WireSamples samples) {
  ByteString bytes = {0xFA, static_cast<std::uint8_t>(0xA0 + index)};
  put(bytes, word_of(10.0 * rpm));
  for (const WireSample& sample : samples) {
    put(bytes, word_of(sample.signal));
    put(bytes, word_of(sample.mm));
    put(bytes, 0);
  }
  const auto sum = static_cast<std::uint8_t>(0xFF - byte_sum(bytes));
  bytes.push_back(sum);
  bytes.push_back(sum);
  return bytes;
}

ByteString camsense_packet(double rpm, double start_deg, double end_deg, WireSamples samples) {
  ByteString bytes = {0x55, 0xAA, 0x03, 0x08};
  put(bytes, word_of(64.0 * rpm));
  put(bytes, word_of(0xA000 + 64.0 * turn_of(start_deg)));
  for (const WireSample& sample : samples) {
    put(bytes, sample.mm > 0.0 ? word_of(sample.mm, 0x7FFF) : std::uint16_t{0x8000});
    bytes.push_back(byte_of(sample.signal));
  }
  put(bytes, word_of(0xA000 + 64.0 * turn_of(end_deg)));
  put(bytes, folded_sum(bytes));
  return bytes;
}

ByteString delta2_packet(double turns_hz, double start_deg, WireSamples samples) {
  const std::size_t body = 5 + 3 * samples.size();
  ByteString bytes = {0xAA};
  put_big(bytes, static_cast<std::uint16_t>(8 + body));
  for (const int byte : {0x01, 0x61, 0xAD}) bytes.push_back(static_cast<std::uint8_t>(byte));
  put_big(bytes, static_cast<std::uint16_t>(body));
  bytes.push_back(byte_of(static_cast<int>(std::lround(20.0 * turns_hz))));
  put_big(bytes, 0);
  put_big(bytes, word_of(100.0 * turn_of(start_deg)));
  for (const WireSample& sample : samples) {
    bytes.push_back(byte_of(sample.signal));
    put_big(bytes, word_of(4.0 * sample.mm));
  }
  put_big(bytes, static_cast<std::uint16_t>(byte_sum(bytes)));
  return bytes;
}

ByteString ydlidar_packet(bool starts_turn, double turns_hz, double start_deg, double end_deg, WireSamples samples,
                          int width, double mm_per_unit) {
  const auto angle = [](double deg) {
    return static_cast<std::uint16_t>(static_cast<int>(std::lround(64.0 * turn_of(deg))) << 1 | 1);
  };
  const int speed = starts_turn ? static_cast<int>(std::lround(10.0 * turns_hz)) : 0;
  ByteString bytes = {0xAA, 0x55, static_cast<std::uint8_t>(speed << 1 | (starts_turn ? 1 : 0)),
                      static_cast<std::uint8_t>(samples.size())};
  put(bytes, angle(start_deg));
  put(bytes, angle(end_deg));
  std::uint16_t sum = static_cast<std::uint16_t>(0x55AA ^ u16_at(bytes, 2) ^ u16_at(bytes, 4) ^ u16_at(bytes, 6));
  ByteString body;
  for (const WireSample& sample : samples) {
    const bool flags = mm_per_unit < 0.3;
    const std::uint16_t range =
        flags ? static_cast<std::uint16_t>(word_of(sample.mm, 16383.0) << 2) : word_of(sample.mm / mm_per_unit);
    if (width == 3) body.push_back(byte_of(sample.signal));
    if (width == 3) sum ^= body.back();
    if (width == 4) put(body, word_of(sample.signal));
    if (width == 4) sum ^= word_of(sample.signal);
    put(body, range);
    sum ^= range;
  }
  put(bytes, sum);
  for (const std::uint8_t byte : body) bytes.push_back(byte);
  return bytes;
}

}  // namespace phasescan::live
