// What a command says to somebody at a terminal. What goes into a pipe or a file is never changed by it.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "phasescan/match/result.hpp"

namespace phasescan::app {

/// Whether standard output is a terminal.
bool for_people();

enum class Tone { kPlain, kGood, kBad, kFaint };
/// Text for standard output, in colour on a terminal that has colours, unless NO_COLOR is set (no-color.org).
std::string toned(std::string_view text, Tone tone);
/// Whether the terminal at a file descriptor takes colours.
bool has_colors(int descriptor);

/// Name and value of one line of an ending.
using EndingLine = std::pair<std::string, std::string>;
/// A few lines at a command's end, names in one column; nothing unless `for_people`.
void print_ending(const std::vector<EndingLine>& lines);

/// Metres with the digits that mean something: "0.42 m", "4.20 m", "42.3 m", "423 m".
std::string metres_text(double metres);
/// "1 scan", "2 scans".
std::string count_text(std::size_t count, std::string_view what);

/// A match's answer in a line: whether it can be used, the pose with as many digits as its covariance gives it, and how
/// sure it is.
std::string match_text(const MatchResult& result);

}  // namespace phasescan::app
