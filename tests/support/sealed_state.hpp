// Files of saved runs, and of that format, whose checksums are put right: what a reader does past them.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "state/container.hpp"

namespace phasescan::testing {

inline constexpr std::size_t kStateHead = 16, kStateEntry = 40;  // bytes; docs/state-file.md has the layout

inline std::uint64_t state_number(const std::string& bytes, std::size_t at, std::size_t n) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < n; ++i) value |= std::uint64_t{static_cast<std::uint8_t>(bytes[at + i])} << (8 * i);
  return value;
}
inline void put_state_number(std::string& bytes, std::size_t at, std::size_t n, std::uint64_t value) {
  for (std::size_t i = 0; i < n; ++i) bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xFFU);
}
inline std::uint32_t state_checksum(const std::string& bytes, std::size_t at, std::size_t n) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + at), n));
}

/// The same bytes with right checksums, and lengths that end with the file; bytes that have no head stay as they are.
inline std::string sealed(std::string bytes) {
  if (bytes.size() < kStateHead + 4) return bytes;
  const std::uint64_t count = state_number(bytes, 12, 4);
  if (count > 64 || kStateHead + count * kStateEntry + 4 > bytes.size()) return bytes;
  const std::size_t end = kStateHead + static_cast<std::size_t>(count) * kStateEntry;
  std::size_t at = end + 4;
  for (std::size_t entry = kStateHead; entry < end; entry += kStateEntry) {
    std::uint64_t n = std::min<std::uint64_t>(state_number(bytes, entry + 24, 8), bytes.size() - at);
    if (entry + kStateEntry == end) n = bytes.size() - at;
    put_state_number(bytes, entry + 24, 8, n);
    if (state_number(bytes, entry + 16, 4) == 0) put_state_number(bytes, entry + 32, 8, n);
    put_state_number(bytes, entry + 20, 4, state_checksum(bytes, at, static_cast<std::size_t>(n)));
    at += static_cast<std::size_t>(n);
  }
  put_state_number(bytes, end, 4, state_checksum(bytes, 0, end));
  return bytes;
}

/// The same content with no section packed: what is changed in it is changed in what is read.
inline std::string unpacked_file(const std::string& file, const StateFileKind& kind = kSavedState) {
  const StateSections read = unpack_state(file, kind);
  std::string bytes = file.substr(0, kStateHead + kStateEntry * read.sections.size() + 4);
  for (std::size_t i = 0; i < read.sections.size(); ++i) {
    const std::size_t entry = kStateHead + kStateEntry * i;
    put_state_number(bytes, entry + 16, 4, 0);
    put_state_number(bytes, entry + 24, 8, read.sections[i].content.size());
    put_state_number(bytes, entry + 32, 8, read.sections[i].content.size());
    bytes += read.sections[i].content;
  }
  return sealed(std::move(bytes));
}

}  // namespace phasescan::testing
