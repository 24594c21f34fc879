// The map that is localised in: of map_server or of a saved run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "phasescan/localize/localizer.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::app {

/// A map that is localised in, and how it came about.
struct KnownMap : PreparedMap {
  bool was_kept = false;  ///< read as it had been prepared
};

/// Option --keep-prepared.
void add_keep_prepared_flag(CLI::App& command, bool& keep);

/// @param map    a yaml of map_server; empty: of `state`
/// @param state  a saved run
/// @param keep   the prepared map is read from FILE.prepared, FILE being `map` or `state`; where that is not there, or
///               is none of this map, it is prepared and written there. What does not work of it is a warning.
/// @throws InputError naming the file for a map that nobody can be localised in
KnownMap load_known_map(const std::string& map, const std::string& state, const LocalizeOptions& options, bool keep);

}  // namespace phasescan::app
