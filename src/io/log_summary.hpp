/// What a log holds, gathered entry by entry: for `info` and for the decision whether its odometry is any.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "phasescan/io/log.hpp"

namespace phasescan {

/// Facts over all entries added.
class LogSummary {
 public:
  void add(const LogEntry& entry);

  std::size_t scans() const { return scans_; }
  /// Scans with at least one hit.
  std::size_t usable_scans() const { return usable_; }
  /// From the first stamp to the last.
  double duration_s() const { return stamp_to_seconds(last_ - first_); }
  /// Whether there is odometry that is worth the name: some, and not just the log's own corrected poses again.
  bool has_odometry() const { return with_odometry_ > 0 && !odometry_equals_corrected(); }
  /// All entries that have both say the same in both: the log lost its odometry, or never had any.
  bool odometry_equals_corrected() const { return with_both_ > 0 && with_both_ == same_in_both_; }

  /// Name and value of each fact, in the order of reading.
  std::vector<std::pair<std::string, std::string>> lines() const;

 private:
  void add_odometry(const LogEntry& entry);
  void add_stamp(Stamp stamp);

  std::size_t scans_ = 0, usable_ = 0;
  std::map<std::string, std::size_t> lasers_;
  std::size_t beams_min_ = 0, beams_max_ = 0;
  double field_of_view_max_ = 0.0;  // [rad]
  std::size_t clockwise_ = 0, with_angles_ = 0, flipped_ = 0;
  double range_max_stated_ = 0.0, longest_hit_ = 0.0;
  std::size_t range_max_unknown_ = 0;
  std::array<std::size_t, 5> states_{};
  std::size_t with_intensities_ = 0, with_time_increment_ = 0;
  Stamp first_ = 0, last_ = 0, previous_ = 0;
  std::size_t backwards_ = 0, repeated_ = 0;
  std::size_t with_odometry_ = 0, with_both_ = 0, same_in_both_ = 0;
  std::optional<Pose2> previous_odometry_;
  double odometry_path_ = 0.0;
};

}  // namespace phasescan
