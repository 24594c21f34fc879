/// Views of the last metres of way: what is found on the map must explain them too.
#pragma once

#include <cstddef>
#include <deque>

#include "localize/hypotheses.hpp"

namespace phasescan {

/// Views that odometry ties together, oldest first.
class PastViews {
 public:
  static constexpr std::size_t kMostViews = 16;  ///< 4 m where views are 0.25 m apart
  /// @param way_m  since the last one
  void add(const JudgedBeams& beams, const Pose2& T_odom_base, double way_m);
  /// Odometry broke: nothing ties them to what follows.
  void clear() { views_.clear(); }
  std::size_t size() const { return views_.size(); }

  /// What the last of them say for the pose T_grid_odom * T_odom_base against a place that the map has not.
  /// @cost about 10 us a view
  double evidence(const MapGrid& grid, const Pose2& T_grid_odom, Led led, std::size_t most_views = kMostViews) const;

 private:
  struct View {
    JudgedBeams beams;
    Pose2 T_odom_base;
  };
  std::deque<View> views_;
};

}  // namespace phasescan
