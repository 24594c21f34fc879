// What a saved run holds, for `phasescan info`.
#pragma once

#include <string>

namespace phasescan::app {

/// Prints lines, or one JSON object. @throws InputError for a damaged file
int info_of_state(const std::string& path, bool json);

}  // namespace phasescan::app
