/// Motions and the twists that make them.
#pragma once

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// The motion `factor` times as long, at the same twist: exp(factor * log(motion)).
inline Pose2 scale_motion(const Pose2& motion, double factor) {
  return exp_twist(log_pose(motion), factor);
}

/// The constant twist of a motion that takes so long. @param seconds  not 0
inline Twist2 mean_twist(const Pose2& motion, double seconds) {
  const Twist2 t = log_pose(motion);
  return {t.vx / seconds, t.vy / seconds, t.omega / seconds};
}

/// The twist of a frame that is fixed to the base, in its own axes, while the base moves with `base`.
inline Twist2 twist_of_frame(const Pose2& T_base_frame, const Twist2& base) {
  const double vx = base.vx - base.omega * T_base_frame.y, vy = base.vy + base.omega * T_base_frame.x;
  const double c = std::cos(T_base_frame.theta), s = std::sin(T_base_frame.theta);
  return {c * vx + s * vy, -s * vx + c * vy, base.omega};
}

}  // namespace phasescan
