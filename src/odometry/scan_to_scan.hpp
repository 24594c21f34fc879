/// The full search in tracking: each scan against the last good one, with no guess.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "odometry/map_points.hpp"
#include "phasescan/scan/scan.hpp"

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
  void remember(Scan scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist);

  /// Whether a scan of that laser is remembered.
  bool knows(const LaserMount& mount) const;
  /// The pose of a scan by a global match (global) against the last one of the same laser, else of another that sees
  /// the world the same way up; empty where there is not even a guess.
  /// @param twist  of the base during the scan, as far as it is known
  /// @cost one match, about 0.1 ms
  std::optional<Found> find(const Scan& scan, const LaserMount& mount, const Twist2& twist);

 private:
  struct View {
    Scan scan;
    LaserMount mount;
    Pose2 T_odom_stamp;
    Twist2 twist;
    double certain_share = 1.0;  // of the matches lately
  };
  View* view_of(const LaserMount& mount);

  ScanMatcher matcher_;
  std::vector<View> views_;  // the latest last
};

}  // namespace phasescan
