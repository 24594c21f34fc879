/// The full search as the tracker's safety net: one scan against the last good one, with no guess.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/odometry/map_points.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Remembers the last scan whose pose is trusted and finds the next one from it, however far the robot turned
/// meanwhile.
class SafetyNet {
 public:
  struct Catch {
    Pose2 T_odom_base;           ///< at the scan's stamp
    Eigen::Matrix3d covariance;  ///< of (x, y, theta) along the axes of odom
    bool sure = true;            ///< the match itself says that it can be trusted
  };

  /// @param twist  of the base during the scan
  void remember(const Scan& scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist);

  /// The pose of a scan by a global match (fft-mh); empty where the match itself says that it cannot be trusted, but
  /// for its best guess where `doubtful` ones are asked for.
  /// @cost one match, about 0.25 ms
  std::optional<Catch> find(const Scan& scan, const LaserMount& mount, bool doubtful = false);

 private:
  ScanMatcher matcher_;
  std::optional<Scan> scan_;
  LaserMount mount_;
  Pose2 T_odom_stamp_;
  Twist2 twist_;
};

}  // namespace phasescan
