/// The pose of a scan on a map that is handed in: near what is expected, around it, and by the full search.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/registration.hpp"
#include "odometry/search_policy.hpp"
#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// A match against the last scan, in the frame of the map.
struct LastScanMatch {
  Pose2 T_map_mid;
  Eigen::Matrix3d covariance;  ///< of (x, y, theta), frame of the map
  bool usable = false, certain = false;
};

/// What is known of the pose before the scan is matched.
struct PoseQuery {
  Pose2 guess;  ///< T_map_base where the first descent begins
  PosePrior prior;
  /// What the learned motion says in place of the prior where the scan leaves a direction open; empty: nothing.
  std::optional<PosePrior> learned;
  /// Matches the scan against the last one: asked for at most once, and only where the map does not show the pose well
  /// (or always, by the policy), for it costs more than all else.
  std::function<std::optional<LastScanMatch>()> match_last_scan;
  double min_overlap = 0.35;  ///< a match with less is none
  double usual_score = 0.5;   ///< mean score of finished matches
};

struct PoseSolution {
  Registration found;
  PosePrior prior;  ///< that it was found with
  double score = 0.0;
  bool wide_search = false, full_search = false;
};

/// Registers the points near the guess; looks along the direction that leaves open; searches nearby where the scan is
/// not explained as scans usually are; falls back to the match against the last scan.
PoseSolution solve_pose(const LocalMap& map, const MapPoints& points, const PoseQuery& query,
                        const SearchPolicy& policy);

}  // namespace phasescan
