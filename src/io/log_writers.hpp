/// The writers behind `make_log_writer`, one function each, and the names of their files.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "phasescan/io/log.hpp"

namespace phasescan {

std::unique_ptr<LogWriter> make_mcap_writer(const std::string& path);
std::unique_ptr<LogWriter> make_carmen_writer(const std::string& path);
std::unique_ptr<LogWriter> make_scan_log_writer(const std::string& path);
std::unique_ptr<LogWriter> make_tum_writer(const std::string& path);

/// By the ending of a file's name, if it is known.
std::optional<LogTarget> find_log_target(std::string_view path);
/// The known endings, for people: ".mcap, .log, ...".
std::string log_endings();

}  // namespace phasescan
