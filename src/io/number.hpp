/// Numbers as text, both ways, the same on every machine (no locale).
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "phasescan/core/time.hpp"

namespace phasescan {

/// Appends the shortest text that reads back as the same number. NaN and infinities as "nan", "inf", "-inf".
template <class T>
void append_number(std::string& out, T value) {
  char text[64];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

/// Reads a plain decimal (digits, perhaps a point and more digits, perhaps a minus in front) from the beginning of
/// [from, end) to the bit as std::from_chars would, and several times faster. Returns where it ends; nullptr where
/// there is none, or one that needs more care (exponent, more than 15 digits): ask std::from_chars then.
inline const char* read_plain_decimal(const char* from, const char* end, double& value) {
  static constexpr double kPowers[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  constexpr int kMostDigits = 15;
  const char* at = from;
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const char* const begin = at;
  while (at != end && *at >= '0' && *at <= '9') digits = 10 * digits + static_cast<std::uint64_t>(*at++ - '0');
  auto count = at - begin;
  std::ptrdiff_t decimals = 0;
  if (count == 0 || count > kMostDigits) return nullptr;
  if (at != end && *at == '.') {
    const char* const point = at++;
    while (at != end && *at >= '0' && *at <= '9' && count <= kMostDigits) {
      digits = 10 * digits + static_cast<std::uint64_t>(*at++ - '0');
      ++count;
    }
    decimals = at - point - 1;
    if (decimals == 0) return nullptr;
  }
  if (count > kMostDigits || (at != end && (*at == 'e' || *at == 'E'))) return nullptr;
  // Both are exact doubles, so that one division rounds once.
  const double size = static_cast<double>(digits) / kPowers[decimals];
  value = negative ? -size : size;
  return at;
}

/// The number that makes up all of `text` (a leading + is fine), or nothing.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  if constexpr (std::is_same_v<T, double>) {
    if (read_plain_decimal(text.data(), text.data() + text.size(), value) == text.data() + text.size() && !text.empty())
      return value;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Seconds as decimal text to nanoseconds without rounding through a double ("1700000000.123456789"); further decimals
/// are cut; an exponent goes through double. Nothing if it is no number or beyond the range of Stamp.
std::optional<Stamp> parse_stamp(std::string_view text);

/// Nanoseconds as seconds with as many decimals as needed; at least `min_decimals`.
void append_stamp(std::string& out, Stamp stamp, int min_decimals = 0);

}  // namespace phasescan
