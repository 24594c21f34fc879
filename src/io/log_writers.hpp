/// The writers behind `make_log_writer`, one function each.
#pragma once

#include <memory>
#include <string>

#include "phasescan/io/log_writer.hpp"

namespace phasescan {

std::unique_ptr<LogWriter> make_mcap_log_writer(const std::string& path);
std::unique_ptr<LogWriter> make_carmen_writer(const std::string& path);

}  // namespace phasescan
