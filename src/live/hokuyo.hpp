// SCIP 2.0: numbers of 6 bits a character, lines of 64 characters with a sum each.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace phasescan::live::scip {

inline constexpr std::size_t kLine = 64;  ///< characters of data in a line

/// The character that stands behind a line.
inline char line_sum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3F) + 0x30);
}

/// Six bits a character, the high ones first.
inline std::uint32_t number(std::string_view text) {
  std::uint32_t value = 0;
  for (const char c : text) value = value << 6 | (static_cast<std::uint32_t>(c - 0x30) & 0x3F);
  return value;
}
inline std::string text(std::uint32_t value, int characters) {
  std::string out;
  for (int i = characters - 1; i >= 0; --i) out += static_cast<char>((value >> (6 * i) & 0x3F) + 0x30);
  return out;
}

/// Type of a Reply: the command that it answers.
constexpr int reply_type(char a, char b) {
  return a << 8 | b;
}

}  // namespace phasescan::live::scip
