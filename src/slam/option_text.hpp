/// The options of a run as lines of text, so that a state of any build tells what it was made with.
#pragma once

#include <string>
#include <string_view>

#include "phasescan/slam/options.hpp"

namespace phasescan {

/// "section.name=value" a line, numbers with all their digits.
std::string format_options(const SlamOptions& options);
/// Options that are not named keep their default; names that are not known are passed over: they are of another build.
/// @throws StateFormatError for a line that is none, or a value out of bounds
SlamOptions parse_options(std::string_view text);

}  // namespace phasescan
