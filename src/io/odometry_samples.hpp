/// Odometry with times of its own, for scans that lie between its samples.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan {

/// The latest samples of one odometry, by time.
class OdometrySamples {
 public:
  /// Between samples at most so far apart the pose is interpolated.
  static constexpr Stamp kLongestGap = 1'000'000'000;
  /// The nearest sample counts for so long where there is none on the other side, if that is asked for.
  static constexpr Stamp kNearest = 200'000'000;

  struct Sample {
    Stamp stamp = 0;
    Pose2 pose;
  };

  /// A sample out of order is left out; after a clock that was set back by a second or more all begins anew.
  void add(const Sample& sample);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  /// Of the last sample; there must be one.
  Stamp last_stamp() const { return samples_.back().stamp; }

  /// Between two samples.
  std::optional<Pose2> between(Stamp stamp) const;
  /// As `between`, else the nearest within kNearest.
  std::optional<Pose2> near(Stamp stamp) const;

 private:
  std::deque<Sample> samples_;
};

/// Whether the scans of a log and its odometry share a clock, told at the end.
class ClockCheck {
 public:
  /// A scan that left with odometry or without, where `samples` was all that there was.
  void add(Stamp scan, bool has_odometry, const OdometrySamples& samples);
  /// Says so where not one scan lies between samples of the odometry.
  void add_remarks(std::vector<LogRemark>& remarks) const;

 private:
  std::size_t with_ = 0, without_ = 0;
  Stamp ahead_ = 0;  ///< of the last scan without: how far it lies behind the last sample
};

/// Entries in the file's order, each with the odometry at its stamp, where odometry comes at other times than scans. An
/// entry waits for a sample behind it: while one may come that is near enough to be interpolated with, and no longer
/// than kMostWaiting entries.
class OdometryQueue {
 public:
  static constexpr std::size_t kMostWaiting = 64;
  /// What a scan gets that does not lie between two samples.
  enum class Outside { kNone, kNearest };

  explicit OdometryQueue(Outside outside) : outside_(outside) {}

  void add_sample(const OdometrySamples::Sample& sample) { samples_.add(sample); }
  /// What has odometry keeps it.
  void add(LogEntry entry) { waiting_.push_back(std::move(entry)); }
  /// The next one that need not wait any longer. @param ended  nothing more will be added
  std::optional<LogEntry> take(bool ended);
  void add_remarks(std::vector<LogRemark>& remarks) const { clock_.add_remarks(remarks); }

 private:
  bool may_leave(const LogEntry& entry) const;

  Outside outside_;
  OdometrySamples samples_;
  ClockCheck clock_;
  std::deque<LogEntry> waiting_;
};

}  // namespace phasescan
