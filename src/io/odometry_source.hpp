/// Whether what a log calls odometry is wheel odometry, told while the log is read: a pipe is read once.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <utility>

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

  /// Names what it remembers, so that a run goes on with it after a stop.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scans", self.scans_);
    v("with_odometry", self.with_odometry_);
    v("with_both", self.with_both_);
    v("same", self.same_);
    v("first_different", self.first_different_);
    v("by_same_poses", self.by_same_poses_);
    v("marks_late", self.marks_late_);
    v("usable", self.usable_);
  }

 private:
  friend class JudgedLog;
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
  /// @param judge  of the log that this one goes on with  @param first  an entry that was read already
  explicit JudgedLog(LogReader& log, bool interpolates = false, OdometryJudge judge = {},
                     std::optional<LogEntry> first = std::nullopt)
      : log_(log), interpolates_(interpolates), judge_(std::move(judge)), first_(std::move(first)) {}

  /// As LogReader::next.
  std::optional<LogEntry> next();
  /// Final once `next` has given nothing.
  OdometrySource source() const { return judge_.source(); }
  /// For a log that goes on with this one: what was decided by the end of this log alone is open again.
  OdometryJudge judge() const;

 private:
  std::optional<LogEntry> next_judged();

  LogReader& log_;
  bool interpolates_;
  OdometryJudge judge_;
  std::optional<LogEntry> first_;
  std::deque<LogEntry> waiting_;
  bool ended_ = false;
  OdometryQueue between_{OdometryQueue::Outside::kNone};
};

}  // namespace phasescan
