/// The full search in tracking: each scan against the last good one, with no guess.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// The last scan of a laser whose pose is trusted. Plain values.
struct LastScan {
  RangeMeasurement measurement;
  Pose2 T_odom_stamp;
  Twist2 twist;                ///< of the base during the scan
  double certain_share = 1.0;  ///< of the matches against this laser's scans lately that were certain

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("measurement", self.measurement);
    v("T_odom_stamp", self.T_odom_stamp);
    v("twist", self.twist);
    v("certain_share", self.certain_share);
  }
};

/// One for each laser, the latest last; at most four. Plain values.
struct LastScans {
  std::vector<LastScan> scans;

  /// Forgets all scans: what comes next is not tied to them.
  void forget() { scans.clear(); }
  /// @param twist  of the base during the scan
  void remember(RangeMeasurement measurement, const Pose2& T_odom_stamp, const Twist2& twist);
  /// Whether a scan of that laser is remembered.
  bool knows(const LaserId& laser) const;
  /// The last scan of that laser, else the latest of another, else null.
  LastScan* of(const LaserId& laser);
};

/// Finds the next scan's pose from the last one, however far the robot turned meanwhile. It knows nothing of the local
/// map: what that was built on wrongly does not mislead it.
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

  explicit ScanToScan(const MatchOptions& options = {}) : matcher_(options) {}

  /// The pose of a scan by a global match against the last one of the same laser, else the latest of another; empty
  /// where there is not even a guess. Each scan counts with the mounting it was taken with.
  /// @param twist  of the base during the scan, as far as it is known
  /// @cost one match, about 0.1 ms
  std::optional<Found> find(LastScans& last, const RangeMeasurement& measurement, const Twist2& twist);

 private:
  ScanMatcher matcher_;
};

}  // namespace phasescan
