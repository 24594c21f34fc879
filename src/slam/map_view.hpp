/// What callers see of a map that is being made.
#pragma once

#include <memory>

#include "phasescan/slam/options.hpp"
#include "phasescan/slam/slam.hpp"
#include "slam/backend_snapshot.hpp"

namespace phasescan {

/// What stands behind a snapshot that `Slam::map` gave; null for any other.
std::shared_ptr<const BackendSnapshot> behind(const MapSnapshot& view);

/// @param snapshot  not null
std::shared_ptr<const MapSnapshot> make_map_view(std::shared_ptr<const BackendSnapshot> snapshot,
                                                 const SlamOptions& options);

}  // namespace phasescan
