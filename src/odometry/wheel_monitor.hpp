/// Wheel odometry, checked against what the scans say.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "state/fields.hpp"

namespace phasescan {

template <>
struct StateFields<WheelCounts> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("steps", self.steps);
    v("agreed", self.agreed);
    v("reversed", self.reversed);
    v("slipped", self.slipped);
    v("jumped", self.jumped);
    visit_since(v, 4, "wheels_m", self.wheels_m);
    visit_since(v, 4, "scans_m", self.scans_m);
  }
};

/// Follows wheel odometry from scan to scan. Plain values.
struct WheelOdometryMonitor {
  std::optional<Pose2> last;  ///< T_odom_base of the wheels with the scan before
  /// 0 (disagreed lately) .. 1 (has agreed for a while), for the distance driven and for the turn.
  double trust_distance = 0.7, trust_turn = 0.7;
  WheelCounts counts;

  /// The wheels' own motion since the last call; empty at the start, after a scan without odometry and for a jump, a
  /// step that no robot of this kind makes (over 2 m or 2 rad).
  std::optional<Pose2> step(const std::optional<Pose2>& T_odom_base);

  /// Compares the wheels' step with what the scans found, and remembers.
  /// @param uncertainty  covariance of the found step's (x, y) [m^2]: nothing is judged by what the scans did not see
  WheelConsistency judge(const Pose2& wheel_step, const Pose2& found_step,
                         const Eigen::Matrix2d& uncertainty = Eigen::Matrix2d::Zero());

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("last", self.last);
    v("trust_distance", self.trust_distance);
    v("trust_turn", self.trust_turn);
    StateFields<WheelCounts>::visit(self.counts, v);
  }
};

}  // namespace phasescan
