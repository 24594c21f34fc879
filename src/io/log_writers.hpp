/// The writers behind `make_log_writer`, one function each.
#pragma once

#include <memory>
#include <string>

#include "phasescan/io/log_writer.hpp"

namespace phasescan {

std::unique_ptr<LogWriter> make_carmen_writer(const std::string& path);
std::unique_ptr<LogWriter> make_tum_writer(const std::string& path);
std::unique_ptr<LogWriter> make_g2o_writer(const std::string& path);
std::unique_ptr<LogWriter> make_map_writer(const std::string& path);

}  // namespace phasescan
