/// The last step of a run: its verdict and the reasons for it, and those of its parts.
#pragma once

#include <map>

#include "odometry/own_body.hpp"
#include "phasescan/slam/result.hpp"
#include "slam/backend.hpp"
#include "slam/input_check.hpp"
#include "slam/scan_ledger.hpp"
#include "slam/trajectory_refinement.hpp"

namespace phasescan {

/// Fills in verdict and findings of a result that is finished otherwise, and of its parts.
/// @param ledger   of the whole run
/// @param refined  whether keyframes are drawn where their scans stand, and not where the graph has them
void judge(const Backend& backend, const ScanLedger& ledger, const RefinementFit& fit, bool refined,
           const std::map<LaserId, OwnBodyState>& bodies, const InputCheckState& input, SlamResult& result);

}  // namespace phasescan
