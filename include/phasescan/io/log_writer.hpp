/// Logs in the formats of other tools: what `phasescan convert` writes.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

enum class LogTarget {
  kMcap,     ///< LaserScan, Odometry, /tf and /tf_static: Foxglove, Lichtblick, rosbag2
  kCarmen,   ///< FLASER for scans of 180 degrees, else ROBOTLASER1 (RAWLASER1 without odometry)
  kScanLog,  ///< JSON Lines
  kTum,      ///< the log's poses
  kG2o,      ///< the log's poses and the steps between them
  kMap,      ///< PGM + YAML: the scans drawn at the log's poses
};

/// Names for flags, in the order of the enum: mcap, carmen, jsonl, tum, g2o, map.
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

/// Topics and frames for lasers that are not named like topics: the first is /scan in the frame laser.
class LaserNames {
 public:
  struct Laser {
    std::string topic, frame;
  };
  /// The names of a log's laser, and whether it is asked for the first time.
  std::pair<const Laser&, bool> of(const std::string& laser);

 private:
  std::map<std::string, Laser> lasers_;
};

/// The scan with its beams moved to the nearest of even angles, as LaserScan and CARMEN can say them; where two meet
/// the nearer one stays. The same scan where its angles are even already. `largest_move_rad` tells how far a beam was
/// moved.
Scan even_scan(const Scan& scan, double* largest_move_rad = nullptr);

}  // namespace phasescan
