/// Scan logs: JSON Lines, a scan a line, optionally with odometry (CONTRACT: scan log). Read through `open_log`.
#pragma once

#include <string>

#include "io/file.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// One entry as one line of JSON without newline. A scan log knows no base: odometry is written as the laser's,
/// T_odom_base * T_base_laser.
std::string format_log_line(const LogEntry& entry);

/// Writes scan logs (.gz by name); whole or not at all.
class ScanLogWriter {
 public:
  explicit ScanLogWriter(const std::string& path) : file_(path) {}
  void write(const LogEntry& entry) { file_.write(format_log_line(entry) + "\n"); }
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace phasescan
