/// What finds the robot on a map, for the localisation node.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "phasescan/map/trinary_map.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan::ros2 {

struct PoseHypothesis {
  Pose2 T_map_base;
  double confidence = 0.0;
};

/// What one scan says.
struct FoundPose {
  TrackingStatus status = TrackingStatus::kInitialising;
  std::optional<Pose2> T_map_base;  ///< empty where nothing is known
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  double confidence = 0.0;
  std::vector<PoseHypothesis> hypotheses;  ///< best first

  /// Whether it is one to go by.
  bool has_pose() const { return T_map_base && (status == TrackingStatus::kOk || status == TrackingStatus::kDegraded); }
};

/// Follows a robot on a map. One thread at a time.
class PoseFinder {
 public:
  virtual ~PoseFinder() = default;
  virtual void initialize(const Pose2& T_map_base, const Eigen::Matrix3d& covariance) = 0;
  virtual void initialize_globally() = 0;
  virtual FoundPose add(const RangeMeasurement& measurement) = 0;
};

/// Makes one for each map that comes.
class PoseFinderFactory {
 public:
  virtual ~PoseFinderFactory() = default;
  /// @throws std::invalid_argument for a map that nothing can be found on
  virtual std::unique_ptr<PoseFinder> make(const TrinaryMap& map) = 0;
};

}  // namespace phasescan::ros2
