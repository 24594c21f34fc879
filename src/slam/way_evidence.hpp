/// The way of a run as evidence: how far it goes, where no scan was matched, where the map has the robot jump.
#pragma once

#include "slam/run_evidence.hpp"

namespace phasescan {

/// Fills way_m, duration_s, moved_m, the gaps and the jumps, from the scans of the result in order. Cost: O(scans).
void follow_way(const SlamResult& result, RunEvidence& evidence);

}  // namespace phasescan
