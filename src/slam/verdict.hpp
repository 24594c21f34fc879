/// From what a run knows of itself to how far its map can be trusted.
#pragma once

#include <string>
#include <vector>

#include "phasescan/slam/result.hpp"
#include "slam/run_evidence.hpp"

namespace phasescan {

/// A kind of reasons and what it takes from the probability (log-odds, above 0: it speaks against the map).
struct ReasonWeight {
  std::string kind;
  double against = 0.0;
};

struct Judgement {
  RunVerdict verdict;
  std::vector<ReasonWeight> weights;  ///< by kind, strongest first; of equals in the order of the table of features
};

/// A logistic function of features, each a logarithm of one number of the evidence (tools/verdict_fit.py fits it).
/// @param in_parts  nothing ties some drives of the run to others: each part may be right, and there is no one map
/// @cost nothing to speak of
Judgement judge_run(const RunEvidence& evidence, bool in_parts);

}  // namespace phasescan
