/// Logs in the formats of other tools.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

enum class LogTarget {
  kMcap,     ///< LaserScan, Odometry, /tf and /tf_static: Foxglove, Lichtblick, rosbag2
  kCarmen,   ///< FLASER for scans of 180 degrees, else ROBOTLASER1 (RAWLASER1 without odometry)
  kScanLog,  ///< JSON Lines
  kTum       ///< the log's poses
};

/// Names for flags, in the order of the enum: mcap, carmen, jsonl, tum.
const std::vector<std::string>& log_target_names();

/// By the ending of a file's name. @throws InputError naming the endings that are known.
LogTarget log_target_for(const std::string& path);

/// Takes entries one by one; the file appears whole with `finish`, or not at all.
class LogWriter {
 public:
  virtual ~LogWriter() = default;
  /// @throws SystemError where the disk is full.
  virtual void add(const LogEntry& entry) = 0;
  /// @throws InputError where the target needs what the log has not (poses), SystemError.
  virtual void finish() = 0;

  /// What could not be said in the target's format, for people: one line each.
  const std::vector<std::string>& losses() const { return losses_; }

 protected:
  void add_loss(const std::string& text);

 private:
  std::vector<std::string> losses_;
};

/// @throws as AtomicFile.
std::unique_ptr<LogWriter> make_log_writer(LogTarget target, const std::string& path);

}  // namespace phasescan
