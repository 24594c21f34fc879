/// A run that was read from a file: whether its parts fit each other, and what is made anew from them.
#pragma once

#include "slam/slam_state.hpp"

namespace phasescan {

/// Puts back what files leave out. @throws StateFormatError where one part names what another has not
void complete_state(SlamState::Data& data);
/// @throws StateFormatError where the scans are not kept as these options ask for
void check_options(const SlamState::Data& data, const SlamOptions& options);

}  // namespace phasescan
