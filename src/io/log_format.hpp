// The formats that `open_log` knows. A format is one file that defines its function below, plus one line in log.cpp's
// table.
#pragma once

#include <memory>
#include <string_view>

#include "io/log_input.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// One readable log format.
struct LogFormat {
  std::string_view name;
  /// Whether this is the format of a file with this prefix, or of the folder.
  bool (*probe)(const LogInput& input);
  /// Takes the input's bytes. @throws InputError, SystemError
  std::unique_ptr<LogReader> (*open)(LogInput& input, const LogOptions& options);
  bool topics = false;   ///< whether LogOptions::topic means anything
  bool columns = false;  ///< whether the geometry and units of LogOptions do
};

LogFormat scan_log_format();
LogFormat carmen_format();
LogFormat rosbag1_format();
LogFormat rosbag2_format();
LogFormat mcap_format();
LogFormat topic_echo_format();
LogFormat echo_csv_format();
LogFormat ultra_simple_format();
LogFormat sick_format();
LogFormat s_lines_format();
LogFormat lowcost_format();
LogFormat csv_format();

}  // namespace phasescan
