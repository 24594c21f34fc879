/// How a log's laser moves by matching its scans, and whether its odometry says the same.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/io/log.hpp"
#include "phasescan/match/scan_matcher.hpp"

namespace phasescan {

/// Counts over pairs of scans of one laser.
struct MotionCounts {
  std::size_t matched = 0;          ///< pairs with a usable match
  std::size_t unmatched = 0;        ///< pairs without
  std::size_t fast = 0;             ///< neighbouring scans turned by more than 20 deg, or moved by more than 0.5 m
  std::size_t neighbours = 0;       ///< pairs of neighbouring scans among the matched ones
  std::size_t turns_same = 0;       ///< the match turns as the odometry does
  std::size_t turns_opposite = 0;   ///< the match turns as much the other way
  std::size_t moves_same = 0;       ///< the match moves where the odometry moves
  std::size_t moves_backwards = 0;  ///< the match moves as far in the opposite direction
  std::size_t compared = 0;         ///< pairs with odometry
  std::size_t disagree = 0;         ///< of these: neither turn nor path fit
};

class MotionCheck {
 public:
  void add(const LogEntry& entry);
  const MotionCounts& counts() const { return counts_; }

 private:
  /// A scan to match later ones with: upright, with its odometry.
  struct Anchor {
    Scan scan;
    std::optional<Pose2> T_odom_laser;
    std::size_t index = 0;
  };

  void match_with_anchor(const Scan& scan, const std::optional<Pose2>& T_odom_laser, bool neighbour);
  void compare(const Pose2& matched, const Pose2& odometry);

  ScanMatcher matcher_;
  std::optional<Anchor> anchor_;
  MotionCounts counts_;
  std::size_t index_ = 0;
  std::size_t next_ = 0;    ///< first index at which a new pair may begin
  std::size_t stride_ = 1;  ///< scans between the beginnings of pairs
  std::size_t at_stride_ = 0;
};

}  // namespace phasescan
