/// Where on the whole map a scan may have been taken.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "localize/map_data.hpp"
#include "localize/query_scan.hpp"

namespace phasescan {

/// A pose that was matched to the end.
struct FoundPose {
  Pose2 T_grid_base;
  MapFit fit;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, theta), frame of the grid
  double of_past = 0.0;  ///< what the views before say for it, where odometry ties them to it
};

/// Poses less than these apart are one.
inline constexpr double kApartM = 0.5, kApartRad = 10.0 * kPi / 180.0;
bool is_apart(const Pose2& a, const Pose2& b);

struct SearchEffort {
  std::size_t candidates = 300, finalists = 10;
};

struct GlobalSearchWorkspace {
  ViewSearch views;
};

/// Poses that explain the scan best, most likely first, all apart from each other.
std::vector<FoundPose> search_map(const LocalizationMap::Data& map, const QueryScan& scan, const SearchEffort& effort,
                                  GlobalSearchWorkspace& work);

/// Registers the scan near a pose and judges what comes of it.
FoundPose match_near(const LocalizationMap::Data& map, const QueryScan& scan, const Pose2& T_grid_base,
                     const std::optional<PosePrior>& prior = std::nullopt);

}  // namespace phasescan
