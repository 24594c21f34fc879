/// What `phasescan convert` makes of a log: one in another format, or a graph or map from the log's own poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// mcap, carmen, jsonl, tum (as log_target_names), then
///   g2o  the log's poses and the steps between them,
///   map  PGM + YAML: the scans drawn at the log's poses.
std::vector<std::string> convert_target_names();

/// By the ending of a file's name. @throws InputError naming the endings that are known.
std::string convert_target_for(const std::string& path);

/// @throws as make_log_writer; std::invalid_argument for a target that is none.
std::unique_ptr<LogWriter> make_convert_writer(const std::string& target, const std::string& path);

}  // namespace phasescan
