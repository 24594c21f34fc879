/// A SLAM node in place of slam_toolbox, without ROS: messages in, messages out, services as functions.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "phasescan/slam/slam.hpp"
#include "ros2/diagnostics.hpp"
#include "ros2/first_map.hpp"
#include "ros2/frames.hpp"
#include "ros2/node_options.hpp"
#include "ros2/outputs.hpp"
#include "ros2/parameters.hpp"
#include "ros2/scan_intake.hpp"

namespace phasescan::ros2 {

/// One thread at a time. Has no clock: `now` is the node's time, of the simulation where use_sim_time is set.
class SlamNode {
 public:
  struct Setup {
    std::string name = "slam_toolbox";
    SlamNodeOptions node;
    SlamOptions slam;
  };
  /// @param executor  runs loops and graph beside the scans; null: within them
  /// @param drawing   draws maps; null: within the scans. Both must outlive the node.
  SlamNode(Setup setup, NodeOutputs& outputs, Executor* executor = nullptr, Executor* drawing = nullptr);
  ~SlamNode();

  Lifecycle lifecycle() const { return lifecycle_; }
  /// Begins a run, or goes on with the one in `state_file`. A file that is there and cannot be read is a "no".
  Answer configure(Stamp now);
  void activate();
  void deactivate(Stamp now);  ///< saves
  void cleanup();

  void on_scan(const std::string& topic, const LaserScan& message, Stamp now);
  void on_transforms(const TFMessage& message, bool is_static, Stamp now);
  void on_odometry(const Odometry& message, Stamp now);
  /// To be called at least 20 times a second: what is published by time.
  void tick(Stamp now);

  std::optional<OccupancyGrid> dynamic_map();
  Answer save_state(const std::string& file, Stamp now);
  /// @param extend  what comes next is another drive; else the run goes on where it ended
  Answer load_state(const std::string& file, bool extend, Stamp now);
  Answer reset(Stamp now);
  void pause(bool paused) { paused_ = paused; }
  bool paused() const { return paused_; }

  ParameterTable& parameters() { return parameters_; }
  Answer set_parameter(const std::string& name, const ParameterValue& value, Stamp now);

  const Diagnostics& diagnostics() const { return told_; }
  const SlamNodeOptions& options() const { return setup_.node; }
  std::size_t scans() const { return slam_ ? slam_->scans() : 0; }
  TrackingStatus status() const { return status_; }
  /// The finished run. The node is unconfigured afterwards. @throws std::logic_error where there is none
  SlamResult finish();

 private:
  void begin(std::optional<SlamState> state);
  void work(Stamp now);
  void add(ReadyScan&& scan, Stamp now);
  void publish(const ScanUpdate& update, const std::optional<Pose2>& T_odom_base, Stamp now);
  /// map -> odom: with every scan, and by time between them.
  void publish_transform(Stamp now);
  void publish_own_odometry(const ScanUpdate& update);
  void publish_map(Stamp stamp);
  void save_when_due(Stamp stamp, Stamp now);
  void rebuild(Stamp now);
  std::vector<KeyValue> values() const;

  Setup setup_;
  NodeOutputs& outputs_;
  Executor* executor_;
  Executor* drawing_;
  ParameterTable parameters_;
  Diagnostics told_;
  ScanIntake intake_;
  MapToOdom map_to_odom_;
  std::unique_ptr<Slam> slam_;
  std::unique_ptr<FirstMap> first_map_;  // null once the run has a map
  SlamOptions slam_in_force_;
  std::shared_ptr<std::atomic<bool>> drawing_now_ = std::make_shared<std::atomic<bool>>(false);
  Lifecycle lifecycle_ = Lifecycle::kUnconfigured;
  TrackingStatus status_ = TrackingStatus::kInitialising;
  std::optional<Stamp> last_scan_, last_map_, last_save_, resumed_at_, last_transform_, last_diagnostics_, last_heard_;
  std::string last_status_;
  bool paused_ = false, publishes_odometry_ = false, extends_ = false;
};

}  // namespace phasescan::ros2
