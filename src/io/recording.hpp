/// The containers of ROS behind one door, told apart by content, packed or not.
#pragma once

#include <memory>
#include <string>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// A rosbag1, a rosbag2 folder or .db3 or an MCAP, each also packed with gzip, bz2, lz4 or zstd; null where `path` is
/// none of them.
/// @throws InputError for a recording that cannot be read at all, SystemError.
std::unique_ptr<LogReader> open_recording(const std::string& path, const LogOptions& options);

}  // namespace phasescan
