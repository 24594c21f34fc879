// The formats that `open_log` knows. A format is one file that defines its function below, plus one line in log.cpp's
// table.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// How much of a file's head is looked at to tell its format.
inline constexpr std::size_t kPrefixBytes = std::size_t{1} << 16;

/// One readable log format.
struct LogFormat {
  std::string_view name;
  /// Whether this is the format of a file with these first bytes (unpacked if packed; at most kPrefixBytes), or of the
  /// folder `path`
  /// (`prefix` is empty then).
  bool (*probe)(const std::string& path, std::string_view prefix);
  /// @throws InputError, SystemError
  std::unique_ptr<LogReader> (*open)(const std::string& path, const LogOptions& options);
  bool topics = false;  ///< whether LogOptions::topic means anything
};

LogFormat scan_log_format();
LogFormat carmen_format();
LogFormat rosbag1_format();
LogFormat rosbag2_format();
LogFormat mcap_format();
LogFormat lowcost_format();
LogFormat csv_format();

}  // namespace phasescan
