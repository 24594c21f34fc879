/// Laser odometry: every scan is matched against a local map of the last keyframes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/odometry/options.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// How a scan's pose was found.
enum class TrackingStatus {
  kInitialising,  ///< no scan so far had enough returns to begin a map: the pose is the origin
  kOk,            ///< matched
  kDegraded,      ///< matched, but only by a wide search or with much of the scan unexplained
  kAmbiguous,     ///< matched, but the scan leaves a direction open, as along a bare corridor: see the covariance
  kLost,          ///< no match was found: the pose is a prediction
};
/// "initialising", "ok", "degraded", "ambiguous", "lost".
const char* to_string(TrackingStatus status);
/// Whether the pose comes from a match.
inline bool is_tracked(TrackingStatus status) {
  return status != TrackingStatus::kInitialising && status != TrackingStatus::kLost;
}

/// What became of one step of wheel odometry: nothing to compare, agrees with the scans, counts backwards what went
/// forwards (or the other way), or is off.
enum class WheelConsistency { kNone, kAgrees, kReversed, kSlips };

/// Steps of wheel odometry so far, by what became of them; jumps are steps that no robot makes.
struct WheelCounts {
  std::size_t steps = 0, agreed = 0, reversed = 0, slipped = 0, jumped = 0;
  /// Ways over the steps in which wheels turned: by their own account, and as the scans were matched [m].
  double wheels_m = 0.0, scans_m = 0.0;
};

struct TrackingDiagnostics {
  double overlap = 0.0;      ///< share of the hits that lie on the local map's surfaces, 0..1
  double residual_m = 0.0;   ///< root mean square of their distances across the surfaces [m]
  bool wide_search = false;  ///< a search around the first answer was needed
  bool full_search = false;  ///< the pose is from a global match against the last good scan
  bool new_segment = false;  ///< the local map was begun anew: only a prediction ties this pose to those before
  WheelConsistency wheels = WheelConsistency::kNone;
};

/// What one scan brought. Frames: odom is the base at the first scan's stamp (where the map began).
struct OdometryUpdate {
  Stamp stamp = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  Pose2 T_odom_base;  ///< at the stamp
  /// Of (x, y, theta) of T_odom_base along the axes of odom, accumulated since the start [m^2, m rad, rad^2]. Symmetric
  /// and positive definite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Twist2 twist;           ///< of the base [m/s, rad/s], 0 where time is unknown
  bool keyframe = false;  ///< the scan became part of the local map
  TrackingDiagnostics diagnostics;
};

/// Tracks a robot through its scans. Deterministic; bounded work and memory per scan; one object per thread.
class Odometry {
 public:
  /// @throws std::invalid_argument naming the option out of bounds.
  explicit Odometry(const OdometryOptions& options = {});
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;

  /// The next scan, of any laser of the robot, in order of time. Never throws for what the world offers.
  /// @cost a match against the local map and one against the last scan: about 0.2 ms for 180 beams
  OdometryUpdate add(const RangeMeasurement& measurement);

  WheelCounts wheels() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
