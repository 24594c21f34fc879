/// Runs every contender over every pair.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "contender.hpp"
#include "eval/pair_outcome.hpp"

namespace phasescan::rivals {

struct RunSettings {
  int repeat = 1;  ///< matches per pair; the fastest one's time is kept
  std::function<void(const std::string& contender, std::size_t threw)> done;  ///< after each contender
};

/// Outcomes contender by contender, `method` its index. The time is the CPU time of all threads of the process, from
/// raw ranges of both scans to the pose. Contenders go over all pairs one after the other, so that none finds its code
/// or data warm because of another, nor a pair warm but for its repeats. A contender that throws has no answer: the
/// pair counts as a failure. Pairs need a truth.
std::vector<PairOutcome> run(const std::vector<ScanPair>& pairs, const std::vector<Contender>& contenders,
                             const RunSettings& settings);

}  // namespace phasescan::rivals
