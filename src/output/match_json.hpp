/// A match's answer as one line of JSON (CONTRACT: match --pairs).
#pragma once

#include <string>
#include <string_view>

#include "methods/any_options.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

/// One line without newline. Without `times` the line is the same for the same input, options and binary. A number that
/// is not finite is written as null.
std::string format_match(std::string_view id, MatchMethod method, const MatchResult& result, bool times = true);

/// {"line": N, "error": ".."}, for a line of a pairs file that holds no pair.
std::string format_pair_error(long line, std::string_view reason);

}  // namespace phasescan
