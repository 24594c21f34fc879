// Checksums of the protocols.
#pragma once

#include <cstdint>
#include <span>

namespace phasescan::live {

/// LD06: polynomial 0x4D, starting at 0, not reflected.
constexpr std::uint8_t crc8_4d(std::span<const std::uint8_t> bytes) {
  std::uint8_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = static_cast<std::uint8_t>(crc & 0x80 ? (crc << 1) ^ 0x4D : crc << 1);
  }
  return crc;
}

/// Neato and Camsense: little-endian words summed, doubling before each, folded to 15 bits.
constexpr std::uint16_t folded_sum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2)
    sum = (sum << 1) + static_cast<std::uint32_t>(bytes[i] | bytes[i + 1] << 8);
  return static_cast<std::uint16_t>(((sum & 0x7FFF) + (sum >> 15)) & 0x7FFF);
}

constexpr std::uint8_t xor_of(std::span<const std::uint8_t> bytes) {
  std::uint8_t all = 0;
  for (const std::uint8_t byte : bytes) all ^= byte;
  return all;
}

constexpr std::uint32_t byte_sum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return sum;
}

/// CRC-32 of IEEE 802.3 over the bytes and `zeros` zero bytes behind them.
constexpr std::uint32_t crc32_padded(std::span<const std::uint8_t> bytes, int zeros) {
  std::uint32_t crc = 0xFFFFFFFF;
  const auto add = [&crc](std::uint8_t byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >> 1) ^ 0xEDB88320 : crc >> 1;
  };
  for (const std::uint8_t byte : bytes) add(byte);
  for (int i = 0; i < zeros; ++i) add(0);
  return ~crc;
}

}  // namespace phasescan::live
