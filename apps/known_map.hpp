// The map that is localised in: of map_server or of a saved run.
#pragma once

#include <string>

#include "phasescan/localize/localizer.hpp"
#include "phasescan/map/trinary_map.hpp"

namespace phasescan::app {

/// The map as it was read, to be drawn, and as it is localised in.
struct KnownMap {
  TrinaryMap drawn;
  LocalizationMap map;
};

/// @param map    a yaml of map_server; empty: of `state`
/// @param state  a saved run
/// @throws InputError naming the file for a map that nobody can be localised in
KnownMap load_known_map(const std::string& map, const std::string& state, const LocalizeOptions& options);

}  // namespace phasescan::app
