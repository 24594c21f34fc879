/// A localisation node in place of amcl, without ROS: messages in, messages out, services as functions.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "phasescan/odometry/odometry.hpp"
#include "ros2/diagnostics.hpp"
#include "ros2/frames.hpp"
#include "ros2/node_options.hpp"
#include "ros2/outputs.hpp"
#include "ros2/parameters.hpp"
#include "ros2/pose_finder.hpp"
#include "ros2/saved_pose.hpp"
#include "ros2/scan_intake.hpp"

namespace phasescan::ros2 {

/// One thread at a time. Has no clock: `now` is the node's time.
class LocalizationNode {
 public:
  struct Setup {
    std::string name = "amcl";
    LocalizationNodeOptions node;
    OdometryOptions odometry;  ///< of odom -> base, where nobody else publishes it
  };
  /// @param finders  must outlive the node
  LocalizationNode(Setup setup, PoseFinderFactory& finders, NodeOutputs& outputs);
  ~LocalizationNode();

  Lifecycle lifecycle() const { return lifecycle_; }
  Answer configure(Stamp now);
  void activate();
  void deactivate(Stamp now);  ///< saves the pose
  void cleanup();

  /// A map that cannot be used leaves the one before in force. Poses on it begin anew: near the last one where there
  /// was one, else without a guess.
  void on_map(const OccupancyGrid& message, Stamp now);
  /// Taken before activation too, and applied then.
  void on_initial_pose(const PoseWithCovarianceStamped& message, Stamp now);
  void on_scan(const std::string& topic, const LaserScan& message, Stamp now);
  void on_transforms(const TFMessage& message, bool is_static, Stamp now);
  void on_odometry(const Odometry& message, Stamp now);
  /// Diagnostics, once a second. To be called at least as often.
  void tick(Stamp now);

  /// The robot may be anywhere.
  Answer reinitialize_global_localization(Stamp now);
  /// Scans are used whether the robot moves or not, so there is nothing to do.
  Answer request_nomotion_update() const { return {}; }

  ParameterTable& parameters() { return parameters_; }
  Answer set_parameter(const std::string& name, const ParameterValue& value, Stamp now);

  const Diagnostics& diagnostics() const { return told_; }
  const LocalizationNodeOptions& options() const { return setup_.node; }
  TrackingStatus status() const { return status_; }

 private:
  struct InitialPose {
    Pose2 T_map_base;
    Eigen::Matrix3d covariance;
  };
  void begin_at_options();
  void apply_initial_pose();
  void work(Stamp now);
  void add(ReadyScan&& scan, Stamp now);
  std::optional<Pose2> odometry_of(const RangeMeasurement& measurement);
  void publish(const FoundPose& found, Stamp stamp);
  void save_pose(Stamp stamp, Stamp now, bool at_once);

  Setup setup_;
  PoseFinderFactory& finders_;
  NodeOutputs& outputs_;
  ParameterTable parameters_;
  Diagnostics told_;
  ScanIntake intake_;
  MapToOdom map_to_odom_;
  std::unique_ptr<PoseFinder> finder_;
  std::unique_ptr<phasescan::Odometry> own_odometry_;
  std::optional<InitialPose> initial_pose_;
  std::optional<SavedPose> last_pose_;
  Lifecycle lifecycle_ = Lifecycle::kUnconfigured;
  TrackingStatus status_ = TrackingStatus::kInitialising;
  double confidence_ = 0.0;
  std::optional<Stamp> last_diagnostics_, last_heard_, last_save_;
  std::string last_status_;
  std::uint64_t scans_ = 0;
  bool activated_before_ = false;
};

}  // namespace phasescan::ros2
