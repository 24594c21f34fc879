/// Fields of a line of text, and the numbers in them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "io/number.hpp"

namespace phasescan {

/// Splits at `separator` (blanks around a field are taken off), or at runs of blanks for ' '.
inline void split_fields(std::string_view line, char separator, std::vector<std::string_view>& out) {
  out.clear();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  std::size_t at = 0;
  if (separator == ' ') {
    for (;;) {
      while (at < line.size() && blank(line[at])) ++at;
      if (at == line.size()) return;
      const std::size_t begin = at;
      while (at < line.size() && !blank(line[at])) ++at;
      out.push_back(line.substr(begin, at - begin));
    }
  }
  for (;;) {
    std::size_t end = line.find(separator, at);
    const bool last = end == std::string_view::npos;
    if (last) end = line.size();
    std::string_view field = line.substr(at, end - at);
    while (!field.empty() && blank(field.front())) field.remove_prefix(1);
    while (!field.empty() && blank(field.back())) field.remove_suffix(1);
    out.push_back(field);
    if (last) return;
    at = end + 1;
  }
}

/// The same, but a separator inside double quotes is none; the quotes go.
inline void split_quoted_fields(std::string_view line, char separator, std::vector<std::string_view>& out) {
  out.clear();
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t at = 0; at <= line.size(); ++at) {
    if (at < line.size() && line[at] == '"') quoted = !quoted;
    if (at < line.size() && (quoted || line[at] != separator)) continue;
    std::string_view field = line.substr(begin, at - begin);
    begin = at + 1;
    while (!field.empty() && blank(field.front())) field.remove_prefix(1);
    while (!field.empty() && blank(field.back())) field.remove_suffix(1);
    if (field.size() > 1 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    out.push_back(field);
  }
}

/// All fields as numbers; false at the first that is none, whose index is then out.size().
inline bool parse_numbers(const std::vector<std::string_view>& fields, std::vector<double>& out) {
  out.clear();
  for (const std::string_view field : fields) {
    const std::optional<double> value = parse_number<double>(field);
    if (!value) return false;
    out.push_back(*value);
  }
  return true;
}

}  // namespace phasescan
