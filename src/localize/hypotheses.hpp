/// Poses that a robot on a map may have, and what speaks for each.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "localize/global_search.hpp"

namespace phasescan {

/// One of them. Frame "grid" as in MapGrid.
struct Hypothesis {
  Pose2 T_grid_odom;
  FoundPose at;         ///< with the last scan
  double weight = 0.0;  ///< log-likelihood of what was seen so far
};

/// Hypotheses best first, and how far the best is ahead where it is alone.
struct HypothesisSet {
  std::vector<Hypothesis> all;
  double margin_alone = 0.0;

  bool empty() const { return all.empty(); }
  /// Of the best to the next.
  double margin() const;
  /// Replaces all by what a search found. @param keep_gap  of log-likelihood, to the best
  void restart(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap, std::size_t most);
  /// Adds what a search found and is not known, as if it had explained the past as well as the best.
  void merge(const std::vector<FoundPose>& found, const Pose2& T_odom_base, double keep_gap, std::size_t most);
  /// Orders them, joins those that came to one pose, and drops those far behind.
  void prune(double keep_gap, std::size_t most);
};

}  // namespace phasescan
