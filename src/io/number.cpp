#include "io/number.hpp"

#include <algorithm>

namespace phasescan {

std::optional<Stamp> parse_stamp(std::string_view text) {
  const auto rough = parse_number<double>(text);
  if (!rough || !(std::abs(*rough) < kMostStampSeconds)) return std::nullopt;
  if (text.find_first_of("eE") != std::string_view::npos) return stamp_from_seconds(*rough);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const auto whole = point == 0 ? std::optional<Stamp>(0) : parse_number<Stamp>(text.substr(0, point));
  if (!whole) return std::nullopt;
  Stamp nanoseconds = *whole * 1'000'000'000;
  Stamp unit = 100'000'000;
  for (std::size_t i = point + 1; i < text.size() && unit > 0; ++i, unit /= 10) nanoseconds += unit * (text[i] - '0');
  return negative ? -nanoseconds : nanoseconds;
}

void append_stamp(std::string& out, Stamp stamp, int min_decimals) {
  auto rest = static_cast<std::uint64_t>(stamp);
  if (stamp < 0) {
    out += '-';
    rest = 0 - rest;
  }
  append_number(out, rest / 1'000'000'000);
  std::string decimals = std::to_string(rest % 1'000'000'000);
  decimals.insert(0, 9 - decimals.size(), '0');
  while (static_cast<int>(decimals.size()) > min_decimals && decimals.ends_with('0')) decimals.pop_back();
  if (!decimals.empty()) out += "." + decimals;
}

}  // namespace phasescan
