#include "ros2/localization_node.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "io/ros_tf.hpp"
#include "phasescan/io/error.hpp"
#include "ros2/due.hpp"

namespace phasescan::ros2 {
namespace {

// As amcl has it where nothing else is said: half a metre and 15 degrees.
const Eigen::Matrix3d kUnsaid = Eigen::Vector3d(0.25, 0.25, deg_to_rad(15.0) * deg_to_rad(15.0)).asDiagonal();

}  // namespace

LocalizationNode::LocalizationNode(Setup setup, PoseFinderFactory& finders, NodeOutputs& outputs)
    : setup_(std::move(setup)),
      finders_(finders),
      outputs_(outputs),
      told_(setup_.name),
      intake_(setup_.node.intake(), told_),
      map_to_odom_({setup_.node.global_frame_id, setup_.node.odom_frame_id, setup_.node.base_frame_id}) {
  parameters_.add("", setup_.node, true);
  for (const char* name : {"odom_frame_id", "global_frame_id", "base_frame_id", "scan_topic", "map_topic", "odom_topic",
                           "odometry", "mounting_from_tf"})
    parameters_.set_while_running(name, false);
}

LocalizationNode::~LocalizationNode() = default;

Answer LocalizationNode::configure(Stamp now) {
  if (lifecycle_ != Lifecycle::kUnconfigured) return {false, "the node is configured already"};
  const LocalizationNodeOptions& options = setup_.node;
  intake_.set_options(options.intake());
  map_to_odom_ = MapToOdom({options.global_frame_id, options.odom_frame_id, options.base_frame_id});
  if (!options.saved_pose_filepath.empty() && options.initialize_at_saved_pose && !initial_pose_) {
    try {
      if (const auto saved = read_saved_pose(options.saved_pose_filepath))
        initial_pose_ = InitialPose{saved->T_map_base, saved->covariance};
    } catch (const std::exception& error) {
      told_.note(Trouble::kSaveFailed, now, error.what());  // a pose can be found without it
    }
  }
  lifecycle_ = Lifecycle::kInactive;
  return {};
}

void LocalizationNode::begin_at_options() {
  const LocalizationNodeOptions& options = setup_.node;
  if (!options.set_initial_pose || (activated_before_ && !options.always_reset_initial_pose)) return;
  if (!initial_pose_ || options.always_reset_initial_pose)
    initial_pose_ = InitialPose{{options.initial_x, options.initial_y, options.initial_yaw}, kUnsaid};
}

void LocalizationNode::activate() {
  if (lifecycle_ != Lifecycle::kInactive) return;
  begin_at_options();
  lifecycle_ = Lifecycle::kActive;
  activated_before_ = true;
  apply_initial_pose();
}

void LocalizationNode::deactivate(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive) return;
  lifecycle_ = Lifecycle::kInactive;
  save_pose(now, now, true);
}

void LocalizationNode::cleanup() {
  finder_.reset();
  own_odometry_.reset();
  map_to_odom_.forget();
  lifecycle_ = Lifecycle::kUnconfigured;
}

void LocalizationNode::on_map(const OccupancyGrid& message, Stamp now) {
  if (lifecycle_ == Lifecycle::kUnconfigured || (finder_ && setup_.node.first_map_only)) return;
  const std::string frame = ros::plain_frame(message.header.frame_id);
  try {
    if (frame != setup_.node.global_frame_id)
      throw std::invalid_argument("map.header.frame_id: " + frame + "; expected " + setup_.node.global_frame_id);
    finder_ = finders_.make(to_map(message));
  } catch (const std::invalid_argument& error) {
    told_.note(Trouble::kBadMap, now, error.what());
    return;
  }
  if (!initial_pose_ && last_pose_) initial_pose_ = InitialPose{last_pose_->T_map_base, kUnsaid};
  apply_initial_pose();
}

void LocalizationNode::on_initial_pose(const PoseWithCovarianceStamped& message, Stamp now) {
  const std::string frame = ros::plain_frame(message.header.frame_id);
  if (frame != setup_.node.global_frame_id) {
    told_.note(Trouble::kBadPose, now,
               fmt::format("initialpose in frame '{}'; expected '{}'", frame, setup_.node.global_frame_id));
    return;
  }
  try {
    initial_pose_ = InitialPose{to_pose2(message.pose.pose), to_covariance3(message.pose.covariance)};
  } catch (const std::invalid_argument& error) {
    told_.note(Trouble::kBadPose, now, error.what());
    return;
  }
  apply_initial_pose();
}

void LocalizationNode::apply_initial_pose() {
  if (lifecycle_ != Lifecycle::kActive || !finder_ || !initial_pose_) return;
  finder_->initialize(initial_pose_->T_map_base, initial_pose_->covariance);
  initial_pose_.reset();
}

void LocalizationNode::on_scan(const std::string& topic, const LaserScan& message, Stamp now) {
  last_heard_ = now;
  if (lifecycle_ != Lifecycle::kActive) return;
  intake_.add_scan(topic, message, now);
  work(now);
}

void LocalizationNode::on_transforms(const TFMessage& message, bool is_static, Stamp now) {
  intake_.add_transforms(message, is_static, now);
  work(now);
}

void LocalizationNode::on_odometry(const Odometry& message, Stamp now) {
  intake_.add_odometry(message, now);
  work(now);
}

void LocalizationNode::work(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive) return;
  if (!finder_) {
    told_.note(Trouble::kNoMap, now, setup_.node.map_topic + ": no map yet; is map_server running and active?");
    intake_.drop_waiting();
    return;
  }
  for (ReadyScan& scan : intake_.take_ready(now)) add(std::move(scan), now);
}

std::optional<Pose2> LocalizationNode::odometry_of(const RangeMeasurement& measurement) {
  if (intake_.has_odometry()) return measurement.T_odom_base;
  if (!own_odometry_) own_odometry_ = std::make_unique<phasescan::Odometry>(setup_.odometry);
  const OdometryUpdate update = own_odometry_->add(measurement);
  if (update.status == TrackingStatus::kInitialising) return std::nullopt;
  intake_.note_own_odometry(update.stamp, update.T_odom_base);
  outputs_.transforms({{map_to_odom_.odom_to_base(update.stamp, update.T_odom_base)}});
  return update.T_odom_base;
}

void LocalizationNode::add(ReadyScan&& scan, Stamp now) {
  const Stamp stamp = scan.measurement.scan.stamp;
  if (scan.new_session) {
    // Where the robot is when a bag begins again is not where it was at its end.
    finder_->initialize_globally();
    own_odometry_.reset();
    map_to_odom_.forget();
    last_save_.reset();
    told_.clock_jumped(now);
  }
  const std::optional<Pose2> T_odom_base = odometry_of(scan.measurement);
  const FoundPose found = finder_->add(scan.measurement);
  ++scans_;
  status_ = found.status;
  confidence_ = found.confidence;
  map_to_odom_.add_scan(stamp, found.has_pose() ? found.T_map_base : std::nullopt, T_odom_base);
  publish(found, stamp);
  if (found.status == TrackingStatus::kLost)
    told_.note(Trouble::kLost, now, "scans do not fit the map where the robot should be; it is looked for everywhere");
  if (found.has_pose()) {
    last_pose_ = SavedPose{stamp, *found.T_map_base, found.covariance};
    save_pose(stamp, now, false);
  }
  tick(now);
}

void LocalizationNode::publish(const FoundPose& found, Stamp stamp) {
  const LocalizationNodeOptions& options = setup_.node;
  if (const auto transform = map_to_odom_.transform(options.transform_tolerance); transform && options.tf_broadcast)
    outputs_.transforms({{*transform}});
  if (found.has_pose())
    outputs_.pose(to_pose_message(stamp, options.global_frame_id, *found.T_map_base, found.covariance));
  ParticleCloud cloud{{stamp, options.global_frame_id}, {}};
  for (const PoseHypothesis& hypothesis : found.hypotheses)
    cloud.particles.push_back({to_pose(hypothesis.T_map_base), hypothesis.confidence});
  outputs_.particles(cloud);
  const std::string status = to_string(found.status);
  if (status != last_status_) outputs_.status({last_status_ = status});
}

void LocalizationNode::save_pose(Stamp stamp, Stamp now, bool at_once) {
  const LocalizationNodeOptions& options = setup_.node;
  if (options.saved_pose_filepath.empty() || !last_pose_) return;
  if (!at_once && (options.save_pose_rate <= 0.0 || !due(last_save_, stamp, 1.0 / options.save_pose_rate))) return;
  last_save_ = stamp;
  try {
    write_saved_pose(options.saved_pose_filepath, *last_pose_);
  } catch (const std::exception& error) {
    told_.note(Trouble::kSaveFailed, now, error.what());
  }
}

void LocalizationNode::tick(Stamp now) {
  if (lifecycle_ != Lifecycle::kActive || !due(last_diagnostics_, now, kDiagnosticsPeriod_s)) return;
  if (!last_heard_) last_heard_ = now;  // it has just begun to listen
  if (due(last_heard_, now, kNoScans_s)) {
    told_.note(
        Trouble::kNoScans, now,
        setup_.node.scan_topic + ": nothing comes; is the driver running, its topic and quality of service right?");
  }
  last_diagnostics_ = now;
  outputs_.diagnostics(told_.report(now, finder_ ? to_string(status_) : "no map",
                                    {{"scans", std::to_string(scans_)},
                                     {"confidence", fmt::format("{:.3f}", confidence_)},
                                     {"odometry", intake_.has_odometry() ? "used"
                                                  : own_odometry_        ? "none: published here"
                                                                         : "not known yet"}}));
}

Answer LocalizationNode::reinitialize_global_localization(Stamp) {
  if (!finder_) return {false, "no map yet"};
  finder_->initialize_globally();
  initial_pose_.reset();
  return {};
}

Answer LocalizationNode::set_parameter(const std::string& name, const ParameterValue& value, Stamp now) {
  const bool running = lifecycle_ != Lifecycle::kUnconfigured;
  try {
    parameters_.set(name, value, running);
  } catch (const std::invalid_argument& error) {
    return {false, error.what()};
  }
  intake_.set_options(setup_.node.intake());
  if (running) told_.note(Trouble::kReconfigured, now, name);
  return {};
}

}  // namespace phasescan::ros2
