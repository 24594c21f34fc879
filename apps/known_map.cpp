#include "known_map.hpp"

#include <stdexcept>
#include <utility>

#include "commands.hpp"
#include "output/map_file.hpp"
#include "phasescan/io/error.hpp"
#include "saved_run.hpp"

namespace phasescan::app {

KnownMap load_known_map(const std::string& map, const std::string& state, const LocalizeOptions& options) {
  const std::string& file = map.empty() ? state : map;
  TrinaryMap drawn;
  if (map.empty()) {
    const LoadedRun loaded = load_run(state);
    drawn = Slam(loaded.saved.state, loaded.saved.options).map()->draw();
  } else {
    if (is_state_file(map))
      throw InputError(map, 0, "is a saved run; expected a map_server yaml (a saved run: --state)");
    bool trap = false;
    drawn = read_map(map, &trap);
    if (trap)
      warn(map +
           ": pixels of 205, unknown as most tools write them, are free by its free_thresh; 0.196 keeps them apart");
  }
  try {
    LocalizationMap made = LocalizationMap::from_grid(drawn, options);
    return {std::move(drawn), std::move(made)};
  } catch (const std::invalid_argument& problem) {
    throw InputError(file, 0, problem.what());
  }
}

}  // namespace phasescan::app
