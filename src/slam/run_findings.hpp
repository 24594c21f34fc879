/// What a run knows of itself that speaks against its map, by kind: the reasons of its verdict.
#pragma once

#include <map>
#include <vector>

#include "odometry/own_body.hpp"
#include "phasescan/slam/result.hpp"
#include "slam/input_check.hpp"
#include "slam/run_evidence.hpp"
#include "slam/verdict.hpp"

namespace phasescan {

/// @param result     finished but for its findings
/// @param judgement  what each kind takes from the probability
/// @param bodies     what of the robot each laser sees
/// @return strongest first; where the verdict is not good at least one
std::vector<RunFinding> run_findings(const SlamResult& result, const RunEvidence& evidence, const Judgement& judgement,
                                     const std::map<LaserId, OwnBodyState>& bodies, const InputCheckState& input);

}  // namespace phasescan
