/// Localisation: a map that is known and measurements in, the robot's pose on that map out. No guess is needed.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
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
  explicit LocalizationMap(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

 private:
  std::shared_ptr<const Data> data_;
};

/// What a map was made of, in 128 bits: other bytes have another digest.
struct MapDigest {
  std::uint64_t low = 0, high = 0;
  friend bool operator==(const MapDigest&, const MapDigest&) = default;
};
/// Of the cells and where they lie. @cost 0.3 ms a million cells
MapDigest digest_of(const TrinaryMap& map);
/// Of a file that a map is made of, such as a saved run.
MapDigest digest_of(std::string_view bytes);

/// A map as it was read, to be drawn, and as it is localised in.
struct PreparedMap {
  TrinaryMap drawn;
  LocalizationMap map;
};

/// Bytes that hold no prepared map, a damaged one, that of another map, of other options or of another version: what
/// is wrong and what was expected, in one line.
class PreparedMapError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bytes of a file that keeps a prepared map, so that it need not be prepared again.
/// @param made_of  what load_prepared is to be asked with: a digest of `drawn`, or of what it is drawn from
/// @throws std::invalid_argument where `map` was not made of `drawn`; PreparedMapError for a map that cannot be kept:
///         cells below 1 cm or above 1 km, or so long and thin that its surfels take far more than the file
/// @cost a tenth of the preparation
std::string encode_prepared(const PreparedMap& prepared, const MapDigest& made_of);
/// Answers are the same, bit for bit, as those on the map that was kept. Bytes may be anything: what is read takes no
/// more memory than they justify.
/// @param options  view_spacing_m and view_range_m must be those of the preparation; the others do not matter
/// @throws PreparedMapError
/// @cost about 10 ms for 1,000 m2: a fiftieth of the preparation
PreparedMap decode_prepared(std::string_view bytes, const MapDigest& made_of, const LocalizeOptions& options = {});

/// Writes a file whole or not at all; of several that write it at once one wins. @throws as encode_prepared;
/// std::system_error
void save_prepared(const std::string& path, const PreparedMap& prepared, const MapDigest& made_of);
/// @throws PreparedMapError naming the file; std::system_error where it cannot be read
PreparedMap load_prepared(const std::string& path, const MapDigest& made_of, const LocalizeOptions& options = {});

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
