/// ROS 1 bags, format 2.0, read record by record from front to back: with or without an index, cut off or whole.
#pragma once

#include <memory>

#include "io/log_input.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// "#ROSBAG V2.0" and the older formats, which `open_rosbag1` refuses by name.
bool looks_like_rosbag1(Bytes first);

/// @throws InputError for an older format.
std::unique_ptr<LogReader> open_rosbag1(LogInput& input, const LogOptions& options);

}  // namespace phasescan
