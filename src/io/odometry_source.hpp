/// Whether what a log calls odometry is wheel odometry, told while the log is read: a pipe is read once.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "io/odometry_samples.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

struct OdometrySource {
  bool usable = false;
  std::string assumed;  ///< what was assumed and why, in words
};

/// Odometry that differs from the log's corrected poses is wheel odometry, and so is odometry of a log without
/// corrected poses. Where both are the same in the first scans they are corrected poses if a mapping program has left
/// its marks (particle filter states) by then, and count as no odometry; without a mark they are odometry, written
/// twice.
///
/// Mapping programs write their marks after each scan they use: of the shared recordings the two corrected ones have
/// them behind the first scan. What is decided stays; what the log shows later is said in `assumed`.
class OdometryJudge {
 public:
  /// Scans with both poses the same that are looked at before it is decided.
  static constexpr std::size_t kFirstScans = 50;

  /// `log` is where the entry comes from: its facts so far are asked for when it is time to decide.
  void add(const LogEntry& entry, const LogReader& log);
  /// The log has ended.
  void finish(const LogReader& log);

  /// Whether more scans may change `source().usable`.
  bool is_open() const { return !usable_.has_value(); }
  OdometrySource source() const;

 private:
  void decide(const LogReader& log);

  std::size_t scans_ = 0, with_odometry_ = 0, with_both_ = 0, same_ = 0;
  std::size_t first_different_ = 0;  ///< 1-based scan
  bool by_same_poses_ = false, marks_late_ = false;
  std::optional<bool> usable_;
};

/// The entries of a log with odometry that is none taken off. Holds entries back only while they could be of either
/// kind: at most OdometryJudge::kFirstScans, and only of logs with corrected poses.
class JudgedLog {
 public:
  /// Scans between two with odometry get what lies between, if `interpolates`. `log` must outlive it.
  explicit JudgedLog(LogReader& log, bool interpolates = false) : log_(log), interpolates_(interpolates) {}

  /// As LogReader::next.
  std::optional<LogEntry> next();
  /// Final once `next` has given nothing.
  OdometrySource source() const { return judge_.source(); }

 private:
  std::optional<LogEntry> next_judged();

  LogReader& log_;
  bool interpolates_;
  OdometryJudge judge_;
  std::deque<LogEntry> waiting_;
  bool ended_ = false;
  OdometryQueue between_{OdometryQueue::Outside::kNone};
};

}  // namespace phasescan
