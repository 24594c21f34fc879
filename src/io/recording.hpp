/// The formats of recorders and vendors' tools behind one door, told apart by content.
#pragma once

#include <memory>
#include <string>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// A rosbag1, a rosbag2 folder or .db3, an MCAP (each also packed with gzip, bz2, lz4 or zstd), a low-cost text log or a
/// CSV; null where `path` is none of them. `options.columns` makes any text a CSV.
/// @throws InputError for a recording that cannot be read at all, SystemError.
std::unique_ptr<LogReader> open_recording(const std::string& path, const LogOptions& options);

}  // namespace phasescan
