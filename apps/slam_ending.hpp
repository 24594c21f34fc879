// What `phasescan slam` says at its end to somebody at a terminal.
#pragma once

#include <string>
#include <vector>

#include "people.hpp"
#include "slam_output.hpp"

namespace phasescan::app {

/// What is odd about the scans, and what of the map does not hang together: a line each on stderr.
/// @return whether some of it is damage
bool warn_of_result(const SlamResult& result, const SlamRun& run, const std::string& folder);

/// The verdict where it is not good, in one line with its strongest reason. @return the exit code: `code`, or that of a
/// run that failed
int report_verdict(const SlamResult& result, const SlamRun& run, int code);

/// Scans, way, loops, size of the map, the verdict with its strongest reason, and what to open.
std::vector<EndingLine> slam_ending(const SlamResult& result, const SlamRun& run, const std::string& folder);

}  // namespace phasescan::app
