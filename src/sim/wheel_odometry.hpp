/// Wheel odometry that drifts, is noisy and slips.
#pragma once

#include <cstdint>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"

namespace phasescan::sim {

struct WheelErrors {
  double scale = 0.0;          ///< constant relative error of distance and of turn, standard deviation
  double noise = 0.0;          ///< random relative error of each step
  double slips_per_min = 0.0;  ///< times a minute of driving that the wheels spin or block
};

/// Adds up true motion with errors, starting at the identity.
class WheelOdometry {
 public:
  WheelOdometry(const WheelErrors& errors, std::uint64_t seed);

  /// T_odom_base after the true pose has moved on to this one at time t [s].
  Pose2 advance(const Pose2& T_world_base, double t);

 private:
  WheelErrors errors_;
  Random random_;
  double distance_scale_;
  double turn_scale_;
  Pose2 T_odom_base_;
  Pose2 last_;
  double last_time_ = 0.0;
  double slip_until_ = -1.0;
  double slip_factor_ = 1.0;
  bool started_ = false;
};

}  // namespace phasescan::sim
