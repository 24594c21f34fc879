/// Localisation: a map that is known and measurements in, the robot's pose on that map out. No guess is needed.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/localize/options.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "phasescan/slam/result.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan {

/// A map made ready to be localised in: surfaces with normals, distances, and what places in its free space look like.
/// Immutable; copies share it, and any number of threads may use it.
class LocalizationMap {
 public:
  struct Data;

  /// Poses on it are in the frame of the map: `map.origin` is applied, its heading too.
  /// @throws std::invalid_argument for a map without cells, with a resolution that is not above 0, an origin that is
  ///         not finite, without an occupied cell that borders on free ones, or without free
  ///         space
  /// @cost about 0.3 s and 10 MB for 1,000 m2
  static LocalizationMap from_grid(const TrinaryMap& map, const LocalizeOptions& options = {});
  /// The map of a run of SLAM as its graph stands. @throws as from_grid
  static LocalizationMap from_state(const SlamState& state, const SlamOptions& slam_options,
                                    const LocalizeOptions& options = {});

  double free_area_m2() const;
  std::size_t views() const;         ///< places that it is described from
  std::size_t memory_bytes() const;  ///< that it takes
  const Data& data() const { return *data_; }

 private:
  explicit LocalizationMap(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

/// A place where the robot may be.
struct PoseEstimate {
  Pose2 T_map_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, theta), frame of the map
  double confidence = 0.0;  ///< probability that it is within 0.1 m and 3 deg of the truth
};

/// How a scan fits the map at the pose found.
struct MapFit {
  double explained = 0.0;       ///< share of the hits that lie on the map's surfaces
  double unmapped = 0.0;        ///< share that lies in front of them: what came since the map was made
  double unknown = 0.0;         ///< of these, the share of the hits that lies where the map knows nothing
  double contradicting = 0.0;   ///< share that lies behind them: what went since, or another place
  double log_likelihood = 0.0;  ///< of the scan at the pose; 0: every hit is where the map has a surface
  std::size_t hits = 0;         ///< that were judged
};

/// What one scan says of the pose. Complete when `add` returns.
struct LocalizationUpdate {
  Stamp stamp = 0;
  ScanId scan = 0;
  TrackingStatus status = TrackingStatus::kInitialising;
  std::optional<Pose2> T_map_base;                           ///< at the scan's stamp; empty where nothing is known
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, theta), frame of the map
  double confidence = 0.0;                                   ///< probability of being within 0.1 m and 3 deg
  std::vector<PoseEstimate> hypotheses;                      ///< best first; the first one is the pose above
  MapFit fit;
  double margin = 0.0;    ///< of log-likelihood, by which the pose is ahead of the next one
  bool searched = false;  ///< the whole map was searched for this scan
  Twist2 twist;           ///< of the base [m/s, rad/s], 0 where time is unknown
  Pose2 T_odom_base;      ///< as tracking from scan to scan has it: continuous, drifts; of a Localizer alone

  /// Whether the pose is one to go by: ok or degraded.
  bool has_pose() const { return T_map_base && (status == TrackingStatus::kOk || status == TrackingStatus::kDegraded); }
};

/// Where the robot is, from one scan and the map alone.
/// @throws std::invalid_argument for a mounting that is not finite
/// @cost a few ms; grows with the free area
LocalizationUpdate locate(const LocalizationMap& map, const RangeMeasurement& measurement,
                          const LocalizeOptions& options = {});

/// Follows a robot on a map: finds it with no guess, keeps several hypotheses while places look alike until motion
/// decides between them, tracks it, says when it is lost and finds it again. Deterministic; one object per thread.
class Localizer {
 public:
  /// @throws std::invalid_argument naming the option out of bounds.
  explicit Localizer(LocalizationMap map, const LocalizeOptions& options = {}, const OdometryOptions& odometry = {});
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// The next scan is taken near this pose. @param covariance of (x, y, theta), frame of the map
  /// @throws std::invalid_argument for a pose that is not finite
  void initialize(const Pose2& T_map_base, const Eigen::Matrix3d& covariance);
  /// The robot may be anywhere: all hypotheses are dropped.
  void initialize_globally();

  /// The next scan, of any laser of the robot, in order of time.
  /// @throws std::invalid_argument for a mounting or a wheel pose that is not finite
  LocalizationUpdate add(const RangeMeasurement& measurement);

  const LocalizationMap& map() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
