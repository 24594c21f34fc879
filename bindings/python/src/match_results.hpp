// What matches answer, as Python has it.
#pragma once

#include <vector>

#include "bind.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan::python {

/// Results side by side.
struct MatchResults {
  std::vector<MatchResult> results;
};

void bind_match_results(py::module_& module);

}  // namespace phasescan::python
