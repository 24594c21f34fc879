/// The full search in tracking: each scan against the last good one, with no guess.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/odometry/map_points.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Remembers the last scan whose pose is trusted and finds the next one from it, however far the robot turned
/// meanwhile. It knows nothing of the local map: what that was built on wrongly does not mislead it.
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

  /// @param twist  of the base during the scan
  void remember(const Scan& scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist);

  /// The pose of a scan by a global match (fft-mh); empty where there is not even a guess.
  /// @param twist  of the base during the scan, as far as it is known
  /// @cost one match, about 0.1 ms
  std::optional<Found> find(const Scan& scan, const LaserMount& mount, const Twist2& twist);

 private:
  ScanMatcher matcher_;
  std::optional<Scan> scan_;
  LaserMount mount_;
  Pose2 T_odom_stamp_;
  Twist2 twist_;
  double certain_share_ = 1.0;  // of the matches lately
};

}  // namespace phasescan
