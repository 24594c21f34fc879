// Sources of `live` that need no sensor: a log at its pace, and a simulated drive.
#pragma once

#include <memory>
#include <string>

#include "phasescan/io/log.hpp"
#include "phasescan/live/live.hpp"

namespace phasescan::app {

/// Scans of a log, as far apart as their stamps. @throws as open_log
std::unique_ptr<live::LiveSource> replay_source(const std::string& log, const LogOptions& options);
/// A robot in a simulated flat.
std::unique_ptr<live::LiveSource> demo_source(std::uint64_t seed);

}  // namespace phasescan::app
