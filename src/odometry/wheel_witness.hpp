/// Wheel odometry as a witness: listened to, checked against what the scans say, and outvoted when it lies.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// What became of one step of wheel odometry.
enum class WheelVerdict { kNone, kAgrees, kReversed, kSlip };

/// Follows wheel odometry from scan to scan.
class WheelWitness {
 public:
  /// The wheels' own motion since the last call; empty at the start, after a scan without odometry and for a jump, a
  /// step that no robot of this kind makes (over 2 m or 2 rad).
  std::optional<Pose2> step(const std::optional<Pose2>& T_odom_base);

  /// Compares the wheels' step with what the scans found, and remembers.
  /// @param doubt  covariance of the found step's (x, y) [m^2]: no verdict on what the scans did not see
  WheelVerdict judge(const Pose2& wheel_step, const Pose2& found_step,
                     const Eigen::Matrix2d& doubt = Eigen::Matrix2d::Zero());

  /// 0 (has been lying) .. 1 (has agreed for a while), for the distance driven and for the turn.
  double trust_distance() const { return trust_distance_; }
  double trust_turn() const { return trust_turn_; }

  struct Counts {
    std::size_t steps = 0, agreed = 0, reversed = 0, slipped = 0, jumped = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  std::optional<Pose2> last_;
  double trust_distance_ = 0.7, trust_turn_ = 0.7;
  Counts counts_;
};

}  // namespace phasescan
