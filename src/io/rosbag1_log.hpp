/// ROS 1 bags, format 2.0, read record by record from front to back: with or without an index, cut off or whole.
#pragma once

#include <memory>
#include <string>

#include "io/byte_source.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// "#ROSBAG V2.0" and the older formats, which `open_rosbag1` refuses by name.
bool looks_like_rosbag1(Bytes first);

/// `stream` stands at the file's first byte. @throws InputError for an older format.
std::unique_ptr<LogReader> open_rosbag1(const std::string& path, ByteStream stream, const LogOptions& options);

}  // namespace phasescan
