// What an RPLIDAR sends. What is in it: live/rplidar.hpp and the decoder.
#include <algorithm>
#include <cmath>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/encode.hpp"
#include "live/rplidar.hpp"

namespace phasescan::live {
namespace {

using namespace rplidar;

void put_low(ByteString& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
std::uint32_t whole_mm(double mm, double most) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(mm, 0.0, most)));
}

/// The 12 bits whose long range is nearest below.
std::uint32_t to_var_bits(std::uint32_t mm) {
  std::uint32_t low = 0, high = 0xFFF;
  while (low < high) {
    const std::uint32_t middle = (low + high + 1) / 2;
    if (var_bits(middle).value <= mm)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

/// A range as a difference to a long one: the nearest that ten bits hold, or "none".
std::uint32_t difference(double mm, const VarBits& base) {
  constexpr int kNone = 0x1FF;
  if (mm <= 0.0) return kNone;
  const double steps = std::round((mm - base.value) / (1 << base.level));
  return std::abs(steps) >= kNone ? kNone : static_cast<std::uint32_t>(static_cast<int>(steps)) & 0x3FF;
}

void put_ultra(ByteString& bytes, WireSamples samples, double next_mm) {
  const auto major = [&](std::size_t i) { return to_var_bits(whole_mm(i < 96 ? samples[i].mm : next_mm, 28000.0)); };
  for (std::size_t i = 0; i < 96; i += 3) {
    const VarBits own = var_bits(major(i)), following = var_bits(major(i + 3));
    const VarBits base = own.value == 0 ? following : own;
    put_low(bytes,
            major(i) | difference(samples[i + 1].mm, base) << 12 | difference(samples[i + 2].mm, following) << 22, 4);
  }
}

std::uint32_t ultra_dense_bits(const WireSample& sample) {
  constexpr std::uint32_t kBase[] = {0, 2046, 8187, 24567};
  const std::uint32_t mm = whole_mm(sample.mm, 60000.0), scale = mm < 2046 ? 0 : mm < 8187 ? 1 : mm < 24567 ? 2 : 3;
  const std::uint32_t steps = (mm - kBase[scale]) / (2 + scale), range_bits = 10 + scale;
  const auto quality = static_cast<std::uint32_t>(std::clamp(sample.signal, 0, 255)) >> scale;
  return scale | steps << 2 | quality << (2 + range_bits);
}

}  // namespace

ByteString rplidar_descriptor(std::uint32_t size, bool repeated, int type) {
  ByteString bytes = {0xA5, 0x5A};
  put_low(bytes, size | (repeated ? 1U : 0U) << 30, 4);
  put_low(bytes, static_cast<std::uint64_t>(type), 1);
  return bytes;
}

ByteString rplidar_answer(int type, std::span<const std::uint8_t> body) {
  ByteString bytes = rplidar_descriptor(static_cast<std::uint32_t>(body.size()), false, type);
  for (const std::uint8_t byte : body) bytes.push_back(byte);
  return bytes;
}

ByteString rplidar_node(const WireSample& sample) {
  const int quality = std::clamp(sample.signal, 0, 63);
  ByteString bytes = {static_cast<std::uint8_t>(quality << 2 | (sample.starts_turn ? 1 : 2))};
  put_low(bytes, static_cast<std::uint64_t>(std::lround(64.0 * sample.turned_deg)) << 1 | 1, 2);
  put_low(bytes, whole_mm(4.0 * sample.mm, 65535.0), 2);
  return bytes;
}

ByteString rplidar_capsule(int type, double start_deg, bool restarts, WireSamples samples, double next_mm) {
  ByteString bytes = {0, 0};
  if (type == kUltraDense) put_low(bytes, 0, 6);  // time and status
  const auto start = static_cast<std::uint32_t>(std::lround(64.0 * start_deg)) % (360 * 64);
  put_low(bytes, start | (restarts ? 0x8000U : 0U), 2);
  if (type == kCapsules) {
    for (std::size_t i = 0; i < 32; i += 2) {  // directions need no correction: 0 in the bits for it
      put_low(bytes, whole_mm(samples[i].mm, 16383.0) << 2, 2);
      put_low(bytes, whole_mm(samples[i + 1].mm, 16383.0) << 2, 2);
      bytes.push_back(0);
    }
  } else if (type == kUltra) {
    put_ultra(bytes, samples, next_mm);
  } else if (type == kDense) {
    for (const WireSample& sample : samples) put_low(bytes, whole_mm(sample.mm, 65535.0), 2);
  } else {
    for (std::size_t i = 0; i < 64; i += 2) {
      const std::uint32_t one = ultra_dense_bits(samples[i]), two = ultra_dense_bits(samples[i + 1]);
      put_low(bytes, one & 0xFFFF, 2);
      put_low(bytes, two & 0xFFFF, 2);
      put_low(bytes, one >> 16 | two >> 16 << 4, 1);
    }
  }
  const std::uint8_t check = xor_of(std::span(bytes).subspan(2));
  bytes[0] = static_cast<std::uint8_t>(0xA0 | (check & 0xF));
  bytes[1] = static_cast<std::uint8_t>(0x50 | check >> 4);
  return bytes;
}

ByteString rplidar_hq(std::uint64_t time_us, WireSamples samples) {
  ByteString bytes = {0xA5};
  put_low(bytes, time_us, 8);
  for (const WireSample& sample : samples) {
    put_low(bytes, static_cast<std::uint64_t>(std::lround(sample.turned_deg * 65536.0 / 360.0)) & 0xFFFF, 2);
    put_low(bytes, whole_mm(4.0 * sample.mm, 1e6), 4);
    put_low(bytes, static_cast<std::uint64_t>(std::clamp(sample.signal, 0, 255)), 1);
    put_low(bytes, sample.starts_turn ? 1 : 0, 1);
  }
  put_low(bytes, crc32_padded(bytes, 3), 4);
  return bytes;
}

}  // namespace phasescan::live
