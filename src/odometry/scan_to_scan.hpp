/// The full search in tracking: each scan against the last good one, with no guess.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/scan/range_measurement.hpp"

namespace phasescan {

/// Remembers the last scan of each laser whose pose is trusted and finds the next one from it, however far the robot
/// turned meanwhile. It knows nothing of the local map: what that was built on wrongly does not mislead it.
class ScanToScan {
 public:
  struct Found {
    Pose2 T_odom_base;           ///< at the scan's stamp
    Eigen::Matrix3d covariance;  ///< of (x, y, theta) along the axes of odom
    bool usable = false;         ///< the match itself says that it can be trusted
    /// Usable beyond doubt, as the matches of the scans before were: where most are ambiguous, as along a corridor, the
    /// few that claim to know are chance.
    bool certain = false;
  };

  /// Forgets all scans: what comes next is not tied to them.
  void forget() { views_.clear(); }
  /// @param twist  of the base during the scan
  void remember(RangeMeasurement measurement, const Pose2& T_odom_stamp, const Twist2& twist);

  /// Whether a scan of that laser is remembered.
  bool knows(const LaserId& laser) const;
  /// The pose of a scan by a global match (fft-mh) against the last one of the same laser, else the latest of
  /// another; empty where there is not even a guess. Each scan counts with the mounting it was taken with.
  /// @param twist  of the base during the scan, as far as it is known
  /// @cost one match, about 0.1 ms
  std::optional<Found> find(const RangeMeasurement& measurement, const Twist2& twist);

 private:
  struct View {
    RangeMeasurement measurement;
    Pose2 T_odom_stamp;
    Twist2 twist;
    double certain_share = 1.0;  // of the matches lately
  };
  View* view_of(const LaserId& laser);

  ScanMatcher matcher_;
  std::vector<View> views_;  // the latest last
};

}  // namespace phasescan
