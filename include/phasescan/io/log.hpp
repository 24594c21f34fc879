/// Logs: of any readable format behind one door, where `open_log` looks at the content, never at the name; and written
/// in the formats of other tools.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// One laser message of a log.
struct LogEntry {
  Scan scan;
  std::optional<Pose2> odometry;  ///< T_odom_base at the scan's stamp (of the laser where the log knows no base)
  std::optional<Pose2>
      corrected;         ///< what the log itself calls its estimate (FLASER's first pose); never used to match or map
  Pose2 T_base_laser;    ///< where the laser sits; identity where the log does not say
  bool flipped = false;  ///< the laser is mounted upside down: its y axis points to the robot's right
  std::string laser;     ///< topic or CARMEN keyword: which laser
  long line = 0;         ///< 1-based line of a text log, ordinal of the message in a binary one
};

/// An entry as a measurement, which tracking takes: upright, whichever way the laser is mounted.
inline RangeMeasurement to_measurement(LogEntry entry) {
  if (entry.flipped) entry.scan = mirrored_scan(entry.scan);
  return {std::move(entry.scan), std::move(entry.laser), entry.T_base_laser, entry.odometry};
}

/// Something in the file that could not be read. What lies around it was.
struct LogDamage {
  std::string kind;  ///< short, countable: "truncated line", "wrong count", "bad chunk", ...
  std::string text;  ///< "FILE:LINE: ..." as the user sees it
};

/// How the beams of a text log lie that states no angles, where the user knows.
struct BeamGeometry {
  std::optional<double> field_of_view = {};  ///< from the first beam to the last [rad]; 2 pi is a full turn
  std::optional<double> angle_min = {};  ///< direction of the first beam [rad]; else half the field, a full turn at 0
  std::optional<double> angle_increment = {};  ///< size of a step [rad], above 0
  bool clockwise = false;                      ///< steps go clockwise, and so do columns of angles
};

/// Directions in the laser's frame [rad], from `from` counter-clockwise to `to`.
struct Sector {
  double from = 0.0, to = 0.0;
};

/// What to read of a log.
struct LogOptions {
  std::string topic = {};       ///< ROS: only this scan topic; empty = all
  std::string frame = {};       ///< ROS: only scans with this frame_id; empty = all that lie in the plane
  std::string columns = {};     ///< text: the names of its columns, separated by commas, where the file has no header
  std::string stamp_unit = {};  ///< text: s, ms, us or ns, where the file does not say
  BeamGeometry beams = {};      ///< text: used where the file does not say

  double range_min = 0.0;           ///< nearer hits are too near [m]
  double range_max = 0.0;           ///< farther hits are out of range [m], 0 = no limit
  std::vector<Sector> masks = {};   ///< beams in these directions are invalid
  std::optional<double> from = {};  ///< scans from this many seconds after the first one on
  std::optional<double> to = {};    ///< scans up to this many seconds after the first one
};

/// What was assumed or left out because the log contradicts itself or does not say, and what it means for a map.
struct LogRemark {
  std::string kind;  ///< short, countable: "angles in degrees", "several frames", ...
  std::string text;  ///< one line, without the file's name
};

/// Reads a log from front to back in bounded memory. One entry per laser message, in the file's order.
class LogReader {
 public:
  virtual ~LogReader() = default;
  /// The next scan, or nothing at the end. A damaged place is skipped and recorded in `damages()`.
  virtual std::optional<LogEntry> next() = 0;
  /// "carmen", "scan log", "rosbag1", ...
  virtual std::string format() const = 0;
  /// Facts for `info`, by name (params, topics, compression, ...).
  virtual std::map<std::string, std::string> facts() const { return {}; }
  /// What was assumed or left out up to here. Complete once `next` has given nothing.
  virtual std::vector<LogRemark> remarks() const { return {}; }

  /// Damage seen so far; at most the first 100 are kept, all are counted.
  virtual const std::vector<LogDamage>& damages() const { return damages_; }
  virtual std::size_t damage_count() const { return damage_count_; }

  /// Share of the file that has been read, 0..1; nothing where its length is not known (a pipe, a database, a folder).
  std::optional<double> share_read() const {
    if (!bytes_read_ || bytes_ == 0) return std::nullopt;
    return std::min(1.0, static_cast<double>(*bytes_read_) / static_cast<double>(bytes_));
  }
  /// For `open_log`: where the bytes of the file are counted as they are read, and how many there are.
  void count_bytes(std::shared_ptr<const std::uint64_t> bytes_read, std::uint64_t bytes) {
    bytes_read_ = std::move(bytes_read);
    bytes_ = bytes;
  }

 protected:
  void add_damage(std::string kind, std::string text) {
    ++damage_count_;
    if (damages_.size() < 100) damages_.push_back({std::move(kind), std::move(text)});
  }

 private:
  std::vector<LogDamage> damages_;
  std::size_t damage_count_ = 0;
  std::shared_ptr<const std::uint64_t> bytes_read_;
  std::uint64_t bytes_ = 0;
};

/// Opens a log: a file, a recording's folder, a pipe, or standard input where `path` is "-". Nothing is read twice;
/// only a database (.db3) needs to be a file.
/// @throws InputError (no such format, nothing readable), SystemError (permission).
std::unique_ptr<LogReader> open_log(const std::string& path, const LogOptions& options = {});

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
