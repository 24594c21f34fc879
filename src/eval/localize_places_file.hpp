/// Maps and scans of `bench localize` kept in a folder: map.yaml, map.pgm, scans.jsonl.gz and truth.txt.
#pragma once

#include <string>

#include "eval/localize_places.hpp"

namespace phasescan {

/// @throws SystemError
void write_places(const std::string& folder, const LocalizePlaces& places);
/// What write_places wrote: the same map and scans. @throws InputError, SystemError
LocalizePlaces read_places(const std::string& folder);
/// Whether a folder holds places.
bool has_places(const std::string& folder);

}  // namespace phasescan
