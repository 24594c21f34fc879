// What summary.json and timing.json of `phasescan slam` say.
#pragma once

#include <nlohmann/json.hpp>

#include "slam_output.hpp"

namespace phasescan::app {

/// Counts, warnings, verdict with its reasons and evidence, inputs, glass. docs/slam.md names the keys.
nlohmann::ordered_json summary_of(const SlamResult& result, const SlamRun& run);

/// CPU and wall time per scan [ms], peak memory of the process.
nlohmann::ordered_json timing_of(const SlamRun& run);

/// Length of a way [m].
double path_length(const std::vector<Pose2>& poses);
/// That of all drives; from one to the next nobody drove.
double path_length(const SlamResult& result);

}  // namespace phasescan::app
