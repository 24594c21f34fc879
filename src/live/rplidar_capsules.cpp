// What is in the capsules of an RPLIDAR.
#include <algorithm>

#include "live/angle_shift.hpp"
#include "live/checks.hpp"
#include "live/rplidar.hpp"

namespace phasescan::live::rplidar {
namespace {

/// 16 x {u16, u16, u8}: quarter millimetres without the low two bits, and 6 bits of 1/8 degree backwards for each.
void read_express(Bytes capsule, std::vector<CapsuleSample>& out) {
  for (std::size_t at = 4; at < 84; at += 5) {
    for (const int half : {0, 1}) {
      const std::uint16_t word = u16_at(capsule, at + 2 * static_cast<std::size_t>(half));
      const int back = (capsule[at + 4] >> (4 * half) & 0xF) | (word & 3) << 4;
      out.push_back({-deg_to_rad(back / 8.0), word & 0xFFFCU, 0.0F});
    }
  }
}

/// 32 x u32: a range of 12 bits, and two more as differences to it and to the next one.
void read_ultra(Bytes capsule, Bytes next, std::vector<CapsuleSample>& out) {
  const auto put = [&out](std::int64_t mm) {
    const auto q2 = static_cast<std::uint32_t>(std::clamp<std::int64_t>(mm, 0, 1 << 20) * 4);
    out.push_back({ultra_angle_shift(q2), q2, 0.0F});
  };
  for (std::size_t i = 0; i < 32; ++i) {
    const std::uint32_t word = u32_at(capsule, 4 + 4 * i);
    const std::uint32_t behind = i < 31 ? u32_at(capsule, 8 + 4 * i) : u32_at(next, 4);
    const VarBits own = var_bits(word & 0xFFF), following = var_bits(behind & 0xFFF);
    const auto signed10 = [](std::uint32_t bits) {
      return static_cast<int>(bits & 0x3FF) - ((bits & 0x200) ? 1024 : 0);
    };
    const int first = signed10(word >> 12), second = signed10(word >> 22);
    const auto none = [](int difference) { return difference == 0x1FF || difference == -0x200; };
    const VarBits base = own.value == 0 ? following : own;
    put(own.value);
    put(none(first) ? 0 : std::int64_t{base.value} + first * (1 << base.level));
    put(none(second) ? 0 : std::int64_t{following.value} + second * (1 << following.level));
  }
}

void read_dense(Bytes capsule, std::vector<CapsuleSample>& out) {
  for (std::size_t at = 4; at < 84; at += 2) out.push_back({0.0, 4U * u16_at(capsule, at), 0.0F});
}

/// 20 bits: in the low two how the others are split into range and quality, finer where it is near.
CapsuleSample ultra_dense_sample(std::uint32_t bits) {
  constexpr std::uint32_t kBase[] = {0, 2046, 8187, 24567};
  const std::uint32_t scale = bits & 3, range_bits = 10 + scale;
  const std::uint32_t steps = (bits >> 2) & ((1U << range_bits) - 1);
  const std::uint32_t quality = (bits >> (2 + range_bits)) << scale;
  return {0.0, 4 * (kBase[scale] + steps * (2 + scale)), static_cast<float>(quality)};
}

/// 32 x {u16, u16, u8}: two samples of 20 bits each.
void read_ultra_dense(Bytes capsule, std::vector<CapsuleSample>& out) {
  for (std::size_t at = 10; at < 170; at += 5) {
    const std::uint32_t high = capsule[at + 4];
    out.push_back(ultra_dense_sample(u16_at(capsule, at) | (high & 0xF) << 16));
    out.push_back(ultra_dense_sample(u16_at(capsule, at + 2) | (high >> 4) << 16));
  }
}

}  // namespace

VarBits var_bits(std::uint32_t bits) {
  if (bits < 512) return {bits, 0};
  if (bits < 1280) return {512 + 2 * (bits - 512), 1};
  if (bits < 1792) return {2048 + 4 * (bits - 1280), 2};
  if (bits < 3328) return {4096 + 8 * (bits - 1792), 3};
  return {16384 + 16 * (bits - 3328), 4};
}

bool capsule_is_right(Bytes capsule) {
  return xor_of(capsule.subspan(2)) == ((capsule[0] & 0xF) | (capsule[1] & 0xF) << 4);
}

void read_capsule(int type, Bytes capsule, Bytes next, std::vector<CapsuleSample>& out) {
  out.clear();
  switch (type) {
    case kCapsules:
      return read_express(capsule, out);
    case kUltra:
      return read_ultra(capsule, next, out);
    case kDense:
      return read_dense(capsule, out);
    default:
      return read_ultra_dense(capsule, out);
  }
}

std::vector<std::uint8_t> request(std::uint8_t command, Bytes payload) {
  std::vector<std::uint8_t> bytes = {0xA5, command};
  if (command & 0x80) {
    bytes.push_back(static_cast<std::uint8_t>(payload.size()));
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    bytes.push_back(xor_of(bytes));
  }
  return bytes;
}

std::vector<std::uint8_t> conf_request(std::uint32_t entry, std::optional<std::uint16_t> mode) {
  std::vector<std::uint8_t> payload;
  for (int i = 0; i < 4; ++i) payload.push_back(static_cast<std::uint8_t>(entry >> (8 * i)));
  if (mode) {
    payload.push_back(static_cast<std::uint8_t>(*mode));
    payload.push_back(static_cast<std::uint8_t>(*mode >> 8));
  }
  return request(kConf, payload);
}

}  // namespace phasescan::live::rplidar
