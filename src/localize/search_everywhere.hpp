/// The slow search that misses nothing: what one scan can know of where it was taken.
#pragma once

#include <vector>

#include "localize/global_search.hpp"

namespace phasescan {

/// All poses of the laser in free cells, by branch and bound over boxes of (x, y, theta): of a box no pose is likelier
/// than if each hit lay nearer to a surface by as much as the box moves it. Boxes that cannot come within `gap` of the
/// best pose known are dropped; from those that are left the scan is registered.
/// @return poses within `gap` of the best, best first, all apart from each other
/// @cost seconds per 1,000 m2
std::vector<FoundPose> search_everywhere(const LocalizationMap::Data& map, const QueryScan& scan, double gap);

}  // namespace phasescan
