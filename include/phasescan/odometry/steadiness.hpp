/// How steadily a robot moves from scan to scan: logs with a scan every half metre jump where others glide.
#pragma once

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// Slow means of how much the motion per scan changed from one to the next.
class Steadiness {
 public:
  /// @param off  where the base is, seen from where the motion before would have taken it
  void add(const Pose2& off) {
    constexpr double kSlow = 0.9, kMostM = 1.0, kMostRad = 1.0;  // one wild answer is not a habit
    change_m_ = kSlow * change_m_ + (1.0 - kSlow) * std::min(kMostM, std::hypot(off.x, off.y));
    change_rad_ = kSlow * change_rad_ + (1.0 - kSlow) * std::min(kMostRad, std::abs(off.theta));
  }

  /// The motion so far says too little of the next scan's pose for tracking to start from it.
  bool jumps() const { return change_m_ > kJumpM || change_rad_ > kJumpRad; }
  double change_m() const { return change_m_; }      ///< [m] a scan
  double change_rad() const { return change_rad_; }  ///< [rad] a scan

 private:
  static constexpr double kJumpM = 0.12, kJumpRad = 0.2;
  double change_m_ = 0.0, change_rad_ = 0.0;
};

}  // namespace phasescan
