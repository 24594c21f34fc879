#include "sim/wheel_odometry.hpp"

#include <cmath>

namespace phasescan::sim {

WheelOdometry::WheelOdometry(const WheelErrors& errors, std::uint64_t seed) : errors_(errors), random_(seed) {
  distance_scale_ = 1.0 + random_.normal(0.0, errors_.scale);
  turn_scale_ = 1.0 + random_.normal(0.0, errors_.scale);
}

Pose2 WheelOdometry::advance(const Pose2& T_world_base, double t) {
  if (started_) {
    constexpr double kSlip_s = 0.5;
    Twist2 step = log_pose(last_.inverse() * T_world_base);
    const double seconds = t - last_time_, driven = std::hypot(step.vx, step.vy);
    if (driven > 0.0 && t > slip_until_ && random_.chance(errors_.slips_per_min * seconds / 60.0)) {
      slip_until_ = t + kSlip_s;
      slip_factor_ = random_.chance(0.5) ? random_.uniform(0.0, 0.6) : random_.uniform(1.3, 2.5);
    }
    const double slip = t <= slip_until_ ? slip_factor_ : 1.0;
    // A wheel robot does not see sideways motion; turning errors come with distance too, as the wheels differ.
    const double size = driven + 0.1 * std::abs(step.omega);
    step.vx = step.vx * distance_scale_ * slip + random_.normal(0.0, errors_.noise * size);
    step.vy = 0.0;
    step.omega =
        step.omega * turn_scale_ * slip + random_.normal(0.0, errors_.noise * (std::abs(step.omega) + 0.3 * driven));
    T_odom_base_ = T_odom_base_ * exp_twist(step);
  }
  started_ = true;
  last_ = T_world_base;
  last_time_ = t;
  return T_odom_base_;
}

}  // namespace phasescan::sim
