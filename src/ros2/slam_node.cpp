#include "ros2/slam_node.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "phasescan/slam/state.hpp"
#include "ros2/due.hpp"

namespace phasescan::ros2 {
SlamNode::SlamNode(Setup setup, NodeOutputs& outputs, Executor* executor, Executor* drawing)
    : setup_(std::move(setup)),
      outputs_(outputs),
      executor_(executor),
      drawing_(drawing),
      told_(setup_.name),
      intake_(setup_.node.intake(), told_),
      map_to_odom_({setup_.node.map_frame, setup_.node.odom_frame, setup_.node.base_frame}) {
  parameters_.add("", setup_.node, false);
  for (const char* name : {"min_laser_range", "max_laser_range", "throttle_scans", "transform_publish_period",
                           "transform_timeout", "map_update_interval", "autosave_period"})
    parameters_.set_while_running(name, true);
  SlamOptions::visit_sections(setup_.slam, [this](std::string_view section, auto& options) {
    parameters_.add(std::string(section) + ".", options, true);
  });
}

SlamNode::~SlamNode() = default;

void SlamNode::begin(std::optional<SlamState> state) {
  const Schedule schedule = setup_.node.deterministic ? Schedule::kDeterministic : Schedule::kLatest;
  slam_ = state ? std::make_unique<Slam>(*state, setup_.slam, schedule, executor_)
                : std::make_unique<Slam>(setup_.slam, schedule, executor_);
  slam_in_force_ = setup_.slam;
  first_map_ = state ? nullptr : std::make_unique<FirstMap>(setup_.slam.map);
  map_to_odom_ = MapToOdom({setup_.node.map_frame, setup_.node.odom_frame, setup_.node.base_frame});
  last_map_.reset();
  last_scan_.reset();
  resumed_at_.reset();
  status_ = TrackingStatus::kInitialising;
}

Answer SlamNode::configure(Stamp now) {
  if (lifecycle_ != Lifecycle::kUnconfigured) return {false, "the node is configured already"};
  intake_.set_options(setup_.node.intake());
  try {
    setup_.slam.validate();
  } catch (const std::invalid_argument& error) {
    return {false, error.what()};
  }
  const std::string& file = setup_.node.state_file;
  if (!file.empty() && std::filesystem::exists(file)) {
    if (const Answer loaded = load_state(file, false, now); !loaded.done) return loaded;
  } else {
    begin(std::nullopt);
  }
  lifecycle_ = Lifecycle::kInactive;
  return {};
}

void SlamNode::activate() {
  if (lifecycle_ == Lifecycle::kInactive) lifecycle_ = Lifecycle::kActive;
}

void SlamNode::deactivate(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive) return;
  lifecycle_ = Lifecycle::kInactive;
  if (!setup_.node.state_file.empty()) save_state(setup_.node.state_file, now);
}

void SlamNode::cleanup() {
  slam_.reset();
  lifecycle_ = Lifecycle::kUnconfigured;
}

void SlamNode::on_scan(const std::string& topic, const LaserScan& message, Stamp now) {
  last_heard_ = now;
  if (lifecycle_ != Lifecycle::kActive || paused_) return;
  intake_.add_scan(topic, message, now);
  work(now);
}

void SlamNode::on_transforms(const TFMessage& message, bool is_static, Stamp now) {
  intake_.add_transforms(message, is_static, now);
  work(now);
}

void SlamNode::on_odometry(const Odometry& message, Stamp now) {
  intake_.add_odometry(message, now);
  work(now);
}

void SlamNode::work(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive || paused_) return;
  for (ReadyScan& scan : intake_.take_ready(now)) add(std::move(scan), now);
}

void SlamNode::add(ReadyScan&& scan, Stamp now) {
  const Stamp stamp = scan.measurement.scan.stamp;
  bool session = scan.new_session;
  if (resumed_at_) {
    const double gap_s = stamp_to_seconds(stamp - *resumed_at_);
    session = extends_ || gap_s < 0.0 || gap_s > setup_.slam.slam.session_gap_s;
    resumed_at_.reset();
  }
  if (session && slam_->scans() > 0) {
    slam_->begin_session();
    map_to_odom_.forget();
    last_map_.reset();
    last_save_.reset();
    told_.clock_jumped(now);
  }
  const ScanUpdate update = slam_->add(scan.measurement);
  last_scan_ = stamp;
  status_ = update.status;
  if (first_map_) first_map_->add(scan.measurement, update);
  publishes_odometry_ = !intake_.has_odometry();
  publish(update, scan.measurement.T_odom_base, now);
  save_when_due(stamp, now);
}

void SlamNode::publish(const ScanUpdate& update, const std::optional<Pose2>& T_odom_base, Stamp now) {
  const bool tracked = is_tracked(update.status);
  const std::optional<Pose2> T_odom = publishes_odometry_ ? std::optional(update.T_odom_base) : T_odom_base;
  map_to_odom_.add_scan(update.stamp, tracked ? std::optional(update.T_map_base()) : std::nullopt, T_odom);
  if (publishes_odometry_ && update.status != TrackingStatus::kInitialising) publish_own_odometry(update);
  if (tracked && !update.repeated) {
    outputs_.pose(to_pose_message(update.stamp, setup_.node.map_frame, update.T_map_base(),
                                  update.map_covariance.value_or(update.odom_covariance)));
  }
  if (update.status == TrackingStatus::kLost)
    told_.note(Trouble::kLost, now, "a scan that fits nothing seen before; the pose is a prediction");
  const std::string status = to_string(update.status);
  if (status != last_status_) outputs_.status({last_status_ = status});
  publish_transform(now);
  if (due(last_map_, update.stamp, setup_.node.map_update_interval)) publish_map(update.stamp);
  tick(now);
}

void SlamNode::publish_transform(Stamp now) {
  if (setup_.node.transform_publish_period <= 0.0) return;
  const auto transform = map_to_odom_.transform(setup_.node.transform_timeout);
  if (!transform) return;
  outputs_.transforms({{*transform}});
  last_transform_ = now;
}

void SlamNode::publish_own_odometry(const ScanUpdate& update) {
  intake_.note_own_odometry(update.stamp, update.T_odom_base);
  outputs_.transforms({{map_to_odom_.odom_to_base(update.stamp, update.T_odom_base)}});
}

void SlamNode::publish_map(Stamp stamp) {
  std::shared_ptr<const MapSnapshot> snapshot = slam_->map();
  const std::vector<MapKeyframe> keyframes = snapshot->keyframes();
  if (keyframes.empty()) {
    if (!first_map_ || first_map_->empty()) return;
    last_map_ = stamp;
    outputs_.map(to_grid(first_map_->draw(), stamp, setup_.node.map_frame));
    return;
  }
  first_map_.reset();
  if (drawing_now_->exchange(true)) return;
  last_map_ = stamp;
  Path path{{stamp, setup_.node.map_frame}, {}};
  for (const MapKeyframe& keyframe : keyframes) path.poses.push_back({path.header, to_pose(keyframe.T_map_base)});
  outputs_.path(path);
  auto draw = [snapshot = std::move(snapshot), stamp, frame = setup_.node.map_frame, &outputs = outputs_,
               drawing_now = drawing_now_] {
    outputs.map(to_grid(snapshot->draw(), stamp, frame));
    drawing_now->store(false);
  };
  if (drawing_ != nullptr) {
    drawing_->run(std::move(draw));
  } else {
    draw();
  }
}

std::optional<OccupancyGrid> SlamNode::dynamic_map() {
  if (!slam_) return std::nullopt;
  const Stamp stamp = last_scan_.value_or(0);
  if (!slam_->map()->keyframes().empty()) return to_grid(slam_->map()->draw(), stamp, setup_.node.map_frame);
  if (!first_map_ || first_map_->empty()) return std::nullopt;
  return to_grid(first_map_->draw(), stamp, setup_.node.map_frame);
}

void SlamNode::tick(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive) return;
  if (due(last_transform_, now, setup_.node.transform_publish_period)) publish_transform(now);
  if (!due(last_diagnostics_, now, kDiagnosticsPeriod_s)) return;
  if (!last_heard_) last_heard_ = now;  // it has just begun to listen
  if (due(last_heard_, now, kNoScans_s) && !paused_) {
    told_.note(
        Trouble::kNoScans, now,
        setup_.node.scan_topic + ": nothing comes; is the driver running, its topic and quality of service right?");
  }
  last_diagnostics_ = now;
  outputs_.diagnostics(told_.report(now, paused_ ? "paused" : to_string(status_), values()));
}

std::vector<KeyValue> SlamNode::values() const {
  return {{"scans", std::to_string(scans())},
          {"waiting", std::to_string(intake_.waiting())},
          {"odometry", intake_.has_odometry() ? "used"
                       : publishes_odometry_  ? "none: published here"
                                              : "not known yet"},
          {"map_version", slam_ ? std::to_string(slam_->map()->version()) : "none"}};
}

Answer SlamNode::save_state(const std::string& file, Stamp now) {
  if (!slam_) return {false, "there is no run to save"};
  try {
    write_state(file, {slam_->checkpoint(), slam_in_force_});
  } catch (const std::exception& error) {
    told_.note(Trouble::kSaveFailed, now, error.what());
    return {false, error.what()};
  }
  return {};
}

void SlamNode::save_when_due(Stamp stamp, Stamp now) {
  const SlamNodeOptions& options = setup_.node;
  if (options.state_file.empty() || options.autosave_period <= 0.0) return;
  if (!last_save_) last_save_ = stamp;
  if (!due(last_save_, stamp, options.autosave_period)) return;
  last_save_ = stamp;
  save_state(options.state_file, now);
}

Answer SlamNode::load_state(const std::string& file, bool extend, Stamp now) {
  try {
    SavedRun run = read_state(file);
    const OptionDifferences differences = compare_options(setup_.slam, run.options);
    if (!differences.fatal.empty()) return {false, file + ": " + differences.fatal.front()};
    const Stamp last = summarize(run.state).last_stamp;
    begin(std::move(run.state));
    resumed_at_ = last;
    extends_ = extend;
  } catch (const std::exception& error) {
    told_.note(Trouble::kSaveFailed, now, error.what());
    return {false, error.what()};
  }
  return {};
}

Answer SlamNode::reset(Stamp now) {
  if (!slam_) return {false, "the node is not configured"};
  begin(std::nullopt);
  told_.note(Trouble::kReconfigured, now, "the run was begun anew");
  return {};
}

Answer SlamNode::set_parameter(const std::string& name, const ParameterValue& value, Stamp now) {
  const bool running = lifecycle_ != Lifecycle::kUnconfigured;
  const Parameter* parameter = parameters_.find(name);
  const ParameterValue before = parameter != nullptr ? parameter->get() : ParameterValue{};
  try {
    parameters_.set(name, value, running);
    if (!running) return {};
    if (name.find('.') != std::string::npos) {
      const OptionDifferences differences = compare_options(setup_.slam, slam_in_force_);
      if (!differences.fatal.empty())
        throw std::invalid_argument(name + ": not while a run goes on: " + differences.fatal.front());
      rebuild(now);
    }
    intake_.set_options(setup_.node.intake());
    told_.note(Trouble::kReconfigured, now, name);
  } catch (const std::invalid_argument& error) {
    if (parameter != nullptr) parameter->set(before);
    return {false, error.what()};
  }
  return {};
}

void SlamNode::rebuild(Stamp) {
  const Schedule schedule = setup_.node.deterministic ? Schedule::kDeterministic : Schedule::kLatest;
  const SlamState state = slam_->checkpoint();
  slam_ = std::make_unique<Slam>(state, setup_.slam, schedule, executor_);
  slam_in_force_ = setup_.slam;
}

SlamResult SlamNode::finish() {
  if (!slam_) throw std::logic_error("SlamNode::finish: there is no run");
  SlamResult result = slam_->finish();
  cleanup();
  return result;
}

}  // namespace phasescan::ros2
