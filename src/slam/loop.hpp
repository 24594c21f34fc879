/// Loops: two visits of one place, matched, and the votes that decide which are believed.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/slam/options.hpp"

namespace phasescan {

/// A match of keyframe `to` with the surroundings of the earlier keyframe `from`.
struct Loop {
  int from = 0;
  int to = 0;
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< of the error in the frame of `to`
  double overlap = 0.0;
};

/// Decides which loops are believed: at once those that hardly move the map, the others when enough of them, found near
/// each other, tell of the same correction. Bounded: what found no company is forgotten.
class LoopJudge {
 public:
  explicit LoopJudge(const LoopOptions& options) : options_(options) {}

  /// @param poses  of the keyframes on the map, as they stand
  /// @param uncertainty_m  how far the map may be off here; loops within it count as small. -small_error_m: none does
  /// @return the loops that are believed now, perhaps earlier ones as well; empty while it has to wait
  std::vector<Loop> add(const Loop& loop, std::span<const Pose2> poses, double uncertainty_m = 0.0);

  std::size_t dropped() const { return dropped_; }
  /// Loops still waiting count as dropped from now on.
  void close() { dropped_ += waiting_.size(), waiting_.clear(); }

 private:
  LoopOptions options_;
  std::deque<Loop> waiting_;
  std::size_t dropped_ = 0;
};

}  // namespace phasescan
