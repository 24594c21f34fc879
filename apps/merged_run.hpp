// Saved runs put together: what the command knows beside their states.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saved_run.hpp"
#include "slam_output.hpp"

namespace phasescan::app {

/// @param order  as MergedStates has it
SlamRun merge_runs(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded,
                   const std::vector<std::size_t>& order);

/// @throws InputError where two states hold the same drive: it would count twice
void refuse_same_drive(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded);

/// Which of the runs began first.
std::size_t begun_first(const std::vector<LoadedRun>& loaded);
/// @throws InputError where their scans are not kept in one way
void refuse_other_keeping(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded);
/// The options of all, where none are given: those of the run that began first. Warns where others differ.
SlamOptions common_options(const std::vector<std::string>& paths, const std::vector<LoadedRun>& loaded);

}  // namespace phasescan::app
