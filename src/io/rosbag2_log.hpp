/// rosbag2 recordings: the folder with its metadata.yaml, or one of its files alone; sqlite3 and MCAP, split or not,
/// files or single messages compressed with zstd.
#pragma once

#include <memory>
#include <string>

#include "io/byte_source.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// @throws InputError where the folder holds no recording.
std::unique_ptr<LogReader> open_rosbag2_folder(const std::string& path, const LogOptions& options);

/// A .db3 alone.
std::unique_ptr<LogReader> open_rosbag2_sqlite(const std::string& path, const LogOptions& options);

/// A .db3 inside a compressed file: sqlite needs a real one, so it is unpacked to the folder for temporary files
/// ($TMPDIR).
std::unique_ptr<LogReader> open_rosbag2_packed_sqlite(const std::string& path, ByteStream stream,
                                                      const LogOptions& options);

}  // namespace phasescan
