/// What a run knows of itself that speaks against its map, by kind.
#pragma once

#include <map>
#include <vector>

#include "odometry/own_body.hpp"
#include "phasescan/slam/result.hpp"
#include "slam/input_check.hpp"

namespace phasescan {

/// @param result  poses of the scans are there
/// @param bodies  what of the robot each laser sees
std::vector<RunFinding> run_findings(const SlamResult& result, const std::map<LaserId, OwnBodyState>& bodies,
                                     const InputCheckState& input);

}  // namespace phasescan
