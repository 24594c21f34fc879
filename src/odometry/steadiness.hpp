/// How steadily a robot moves from scan to scan: logs with a scan every half metre jump where others glide.
#pragma once

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// How much the motion per scan is to be expected to change from one scan to the next: by habit, and by what robots can
/// do in the time between them.
class Steadiness {
 public:
  /// @param period_s  the usual time between scans, 0 = unknown
  void set_period(double period_s) {
    const double square = period_s * period_s;
    floor_m_ = std::min(kMostFloorM, kAcceleration * square);
    floor_rad_ = std::min(kMostFloorRad, kTurnAcceleration * square);
  }
  /// @param off  where the base is, seen from where the motion before would have taken it
  void add(const Pose2& off) {
    constexpr double kSlow = 0.9, kMostM = 0.8, kMostRad = 0.8;  // one wild answer is not a habit
    habit_m_ = kSlow * habit_m_ + (1.0 - kSlow) * std::min(kMostM, std::hypot(off.x, off.y));
    habit_rad_ = kSlow * habit_rad_ + (1.0 - kSlow) * std::min(kMostRad, std::abs(off.theta));
  }

  /// The motion so far says too little of the next scan's pose for tracking to start from it.
  bool jumps() const { return change_m() > kJumpM || change_rad() > kJumpRad; }
  double change_m() const { return std::max(habit_m_, floor_m_); }        ///< [m] a scan
  double change_rad() const { return std::max(habit_rad_, floor_rad_); }  ///< [rad] a scan

 private:
  static constexpr double kJumpM = 0.12, kJumpRad = 0.2;
  static constexpr double kAcceleration = 0.5, kMostFloorM = 0.5;         // [m/s^2] [m]
  static constexpr double kTurnAcceleration = 0.8, kMostFloorRad = 0.35;  // [rad/s^2] [rad]
  double habit_m_ = 0.0, habit_rad_ = 0.0;
  double floor_m_ = 0.0, floor_rad_ = 0.0;
};

}  // namespace phasescan
