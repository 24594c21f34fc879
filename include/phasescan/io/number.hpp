/// Numbers as text, both ways, the same on every machine (no locale).
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "phasescan/core/time.hpp"

namespace phasescan {

/// Appends the shortest text that reads back as the same number. NaN and infinities as "nan", "inf", "-inf".
template <class T>
void append_number(std::string& out, T value) {
  char text[64];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

/// The number that makes up all of `text` (a leading + is fine), or nothing.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
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
