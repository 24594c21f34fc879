/// What a killed process leaves of the files that it wrote.
#pragma once

#include <string>

namespace phasescan {

/// Deletes what processes that are gone left beside `path`: a kill in the middle of a write leaves its temporary file.
/// Never fails: what cannot be deleted stays.
void drop_leftovers(const std::string& path) noexcept;

}  // namespace phasescan
