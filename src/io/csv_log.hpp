/// CSV and plain text of cheap sensors: a scan a line or a beam a line, with a header or named columns.
#pragma once

#include <memory>
#include <string_view>

#include "io/log_input.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// True if the beginning of a text has a header that names ranges (in a comment line, too).
bool looks_like_csv(std::string_view prefix);

/// `options.columns` (names separated by commas) replaces the header.
/// @throws InputError where the names make no log.
std::unique_ptr<LogReader> open_csv(LogInput& input, const LogOptions& options);

}  // namespace phasescan
