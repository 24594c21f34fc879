/// What one scan brought: the answer of Slam and of a localiser to one measurement.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/odometry/odometry.hpp"

namespace phasescan {

/// Number of a measurement, from 0, in the order in which they were added.
using ScanId = std::int64_t;
/// Number of a keyframe, from 0, in the order in which tracking chose them.
using KeyframeId = std::int64_t;

/// Complete when `add` returns: nothing in it waits for the map.
struct ScanUpdate {
  Stamp stamp = 0;
  ScanId scan = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  bool repeated = false;  ///< the same message as the one before: it has that one's pose and counts for nothing else
  Pose2 T_odom_base;      ///< at the scan's stamp; continuous, drifts
  Eigen::Matrix3d odom_covariance = Eigen::Matrix3d::Zero();  ///< of T_odom_base, since the start
  Pose2 T_map_odom;               ///< correction by the map; changes when a result of loops and graph enters
  std::uint64_t map_version = 0;  ///< counts those results
  std::optional<Eigen::Matrix3d> map_covariance;  ///< of T_map_base(); empty before the first result
  Twist2 twist;                                   ///< of the base, 0 where time is unknown
  std::optional<KeyframeId> keyframe;             ///< the newest keyframe, if this scan brought one or made one final
  TrackingDiagnostics diagnostics;

  /// Where the base stands on the map, as far as is known now.
  Pose2 T_map_base() const { return T_map_odom * T_odom_base; }
};

}  // namespace phasescan
