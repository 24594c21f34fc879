/// MCAP files, read record by record from front to back: indexes and summaries are not needed and not believed.
#pragma once

#include <memory>
#include <string>

#include "io/byte_source.hpp"
#include "io/ros_log.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

bool looks_like_mcap(Bytes first);

/// The messages of a file as part of a larger log (a split of a rosbag2 recording).
std::unique_ptr<ros::Container> mcap_container(const std::string& path, ByteStream stream, ros::RosLogReader& log);

/// `stream` stands at the file's first byte.
std::unique_ptr<LogReader> open_mcap(const std::string& path, ByteStream stream, const LogOptions& options);

}  // namespace phasescan
