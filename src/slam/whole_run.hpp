/// A run whose path was thinned as a run that never had more scans.
#pragma once

#include "slam/slam_state.hpp"

namespace phasescan {

/// Numbers the scans and keyframes that are kept from 0 on, wherever they stand; files and results know no others.
/// @cost O(scans + keyframes kept)
void make_whole(SlamState::Data& data);

}  // namespace phasescan
