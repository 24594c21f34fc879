/// The slow search that misses nothing: what one scan can know of where it was taken.
#pragma once

#include <vector>

#include "localize/global_search.hpp"

namespace phasescan {

struct PosesEverywhere {
  std::vector<FoundPose> found;  ///< within the gap of the best, best first, all apart from each other
  bool finished = true;          ///< else the search was given up: what it found may lack poses, and says nothing
};

/// All poses of the laser in free cells, by branch and bound over boxes of (x, y, theta): of a box no pose is likelier
/// than if each hit lay nearer to a surface by as much as the box moves it. Boxes that cannot come within `gap` of the
/// best pose known are dropped; from those that are left the scan is registered.
/// @param most_steps  after which it is given up, 0: never; a box is one, a registration 200
/// @cost seconds per 1,000 m2; about 1 us a step
PosesEverywhere search_everywhere(const LocalizationMap::Data& map, const QueryScan& scan, double gap,
                                  std::size_t most_steps = 0);

}  // namespace phasescan
