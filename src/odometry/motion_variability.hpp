/// How much the motion per scan changes from scan to scan: logs with a scan every half metre leave much open where
/// dense ones leave centimetres.
#pragma once

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// How much the motion per scan is to be expected to change from one scan to the next: by what was seen, and by what
/// robots can do in the time between them. Plain values.
struct MotionVariability {
  double seen_m = 0.0, seen_rad = 0.0;    ///< slow means of the changes [m], [rad] a scan
  double floor_m = 0.0, floor_rad = 0.0;  ///< by the time between scans

  /// @param period_s  the usual time between scans, 0 = unknown
  void set_period(double period_s) {
    // Accelerations of indoor robots [m/s^2], [rad/s^2], and the changes beyond which a period is no scan's [m], [rad].
    constexpr double kAcceleration = 0.5, kMostFloorM = 0.5, kTurnAcceleration = 0.8, kMostFloorRad = 0.35;
    const double square = period_s * period_s;
    floor_m = std::min(kMostFloorM, kAcceleration * square);
    floor_rad = std::min(kMostFloorRad, kTurnAcceleration * square);
  }
  /// @param off  where the base is, seen from where the motion before would have taken it
  void add(const Pose2& off) {
    constexpr double kMemory = 0.9;                 // weight of the past
    constexpr double kMostM = 0.8, kMostRad = 0.8;  // one wild answer does not change what is usual
    seen_m = kMemory * seen_m + (1.0 - kMemory) * std::min(kMostM, std::hypot(off.x, off.y));
    seen_rad = kMemory * seen_rad + (1.0 - kMemory) * std::min(kMostRad, std::abs(off.theta));
  }

  /// The motion so far says too little of the next scan's pose for tracking to start from it.
  bool is_sparse() const {
    // [m], [rad]: more than the gates of a registration and the lattice around it find back.
    constexpr double kSparseM = 0.12, kSparseRad = 0.2;
    return change_m() > kSparseM || change_rad() > kSparseRad;
  }
  double change_m() const { return std::max(seen_m, floor_m); }        ///< [m] a scan
  double change_rad() const { return std::max(seen_rad, floor_rad); }  ///< [rad] a scan

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("seen_m", self.seen_m);
    v("seen_rad", self.seen_rad);
    v("floor_m", self.floor_m);
    v("floor_rad", self.floor_rad);
  }
};

}  // namespace phasescan
