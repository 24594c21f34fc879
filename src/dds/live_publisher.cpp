#include "dds/live_publisher.hpp"

#include <fmt/format.h>

#include "live/clocks.hpp"
#include "ros2/due.hpp"

namespace phasescan::dds {
namespace {

using ros2::Direction;
using ros2::Role;

constexpr double kAhead_s = 0.2;  // as slam_toolbox's transform_timeout
constexpr double kMapPeriod_s = 2.0, kDiagnosticsPeriod_s = 1.0;

template <class M>
Writer<M> writer(Participant& participant, std::string_view topic) {
  const ros2::Endpoint& endpoint = ros2::endpoint(Role::kSlam, Direction::kOut, topic);
  return participant.writer<M>(endpoint.name, endpoint.qos);
}

}  // namespace

struct LivePublisher::Topics {
  explicit Topics(Participant& p)
      : tf(writer<ros2::TFMessage>(p, "/tf")),
        static_tf(p.writer<ros2::TFMessage>("/tf_static", {true, true, 1})),
        pose(writer<ros2::PoseWithCovarianceStamped>(p, "pose")),
        map(writer<ros2::OccupancyGrid>(p, "map")),
        map_metadata(writer<ros2::MapMetaData>(p, "map_metadata")),
        path(writer<ros2::Path>(p, "path")),
        status(writer<ros2::String>(p, "status")),
        diagnostics(writer<ros2::DiagnosticArray>(p, "/diagnostics")),
        initial_pose(p.reader<ros2::PoseWithCovarianceStamped>(
            "initialpose", ros2::endpoint(Role::kLocalization, Direction::kIn, "initialpose").qos)) {}

  Writer<ros2::TFMessage> tf, static_tf;
  Writer<ros2::PoseWithCovarianceStamped> pose;
  Writer<ros2::OccupancyGrid> map;
  Writer<ros2::MapMetaData> map_metadata;
  Writer<ros2::Path> path;
  Writer<ros2::String> status;
  Writer<ros2::DiagnosticArray> diagnostics;
  Reader<ros2::PoseWithCovarianceStamped> initial_pose;
  std::optional<Writer<ros2::PoseWithCovarianceStamped>> amcl_pose;  // on a known map
  std::optional<Writer<ros2::LaserScan>> scan;
};

LivePublisher::LivePublisher(std::shared_ptr<LiveLink> link, const OccupancyOptions& map, bool known_map,
                             std::function<void(const Pose2&, const Eigen::Matrix3d&)> set_pose)
    : link_(std::move(link)),
      set_pose_(std::move(set_pose)),
      topics_(std::make_shared<Topics>(link_->participant)),
      map_to_odom_({link_->map_frame, link_->odom_frame, link_->base_frame}),
      first_map_(std::make_unique<ros2::FirstMap>(map)) {
  // As drivers do it; the reader of the same topic asks for no more.
  if (known_map) {
    const ros2::Endpoint& endpoint = ros2::endpoint(Role::kLocalization, Direction::kOut, "amcl_pose");
    topics_->amcl_pose.emplace(link_->participant.writer<ros2::PoseWithCovarianceStamped>(endpoint.name, endpoint.qos));
  }
  if (!link_->scans_from_ros)
    topics_->scan.emplace(link_->participant.writer<ros2::LaserScan>("scan", {false, false, 10}));
}

LivePublisher::~LivePublisher() = default;

void LivePublisher::take(const live::LiveUpdate& live) {
  ++scans_;
  if (live.located) first_map_.reset();  // the map is there
  if (first_map_) first_map_->add(*live.measurement, live.update);
  if (topics_->scan) publish_scan(*live.measurement);
  publish_frames(live);
  if (const std::string status = to_string(live.update.status); status != last_status_)
    topics_->status.write({last_status_ = status});
  publish_map(live);
  publish_diagnostics(live);
  take_poses();
}

void LivePublisher::publish_scan(const RangeMeasurement& measurement) {
  const std::string frame = measurement.laser.empty() ? "laser" : measurement.laser;
  const auto mounted = mounted_.find(frame);
  if (mounted == mounted_.end() || !(mounted->second == measurement.T_base_laser)) {
    mounted_[frame] = measurement.T_base_laser;
    ros2::TFMessage message;
    for (const auto& [laser, pose] : mounted_)
      message.transforms.push_back(ros2::to_transform(measurement.scan.stamp, link_->base_frame, laser, pose));
    topics_->static_tf.write(message);
  }
  try {
    topics_->scan->write(ros::from_scan(measurement.scan, frame, 0.0));
  } catch (const std::invalid_argument&) {
    // Beams that are not even have no LaserScan.
  }
}

void LivePublisher::publish_frames(const live::LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  const bool tracked = live.has_pose();
  const bool own = !live.measurement->T_odom_base;
  std::string base;
  {
    const std::lock_guard lock(link_->mutex);
    base = link_->base_frame;
    if (update.status == TrackingStatus::kLost)
      link_->told.note(ros2::Trouble::kLost, live::system_ns(), "a scan that fits nothing seen before");
  }
  map_to_odom_.add_scan(update.stamp, tracked ? std::optional(update.T_map_base()) : std::nullopt,
                        own ? update.T_odom_base : *live.measurement->T_odom_base);
  ros2::TFMessage message;
  if (own && update.status != TrackingStatus::kInitialising)
    message.transforms.push_back(ros2::to_transform(update.stamp, link_->odom_frame, base, update.T_odom_base));
  if (const auto transform = map_to_odom_.transform(kAhead_s)) message.transforms.push_back(*transform);
  if (!message.transforms.empty()) topics_->tf.write(message);
  if (tracked && !update.repeated) {
    const auto pose = ros2::to_pose_message(update.stamp, link_->map_frame, update.T_map_base(),
                                            update.map_covariance.value_or(update.odom_covariance));
    topics_->pose.write(pose);
    if (topics_->amcl_pose) topics_->amcl_pose->write(pose);
  }
}

void LivePublisher::publish_map(const live::LiveUpdate& live) {
  const Stamp stamp = live.update.stamp;
  if (!ros2::due(last_map_, stamp, kMapPeriod_s) || drawing_now_->load()) return;
  const std::vector<MapKeyframe> keyframes = live.map->keyframes();
  std::function<TrinaryMap()> draw;
  if (!keyframes.empty() || live.located) {
    first_map_.reset();
    if (last_version_ == live.map->version() && last_map_) return;
    last_version_ = live.map->version();
    draw = [map = live.map] { return map->draw(); };
  } else if (first_map_ && !first_map_->empty()) {
    draw = [map = first_map_->draw()] { return map; };
  } else {
    return;
  }
  last_map_ = stamp;
  ros2::Path path{{stamp, link_->map_frame}, {}};
  for (const MapKeyframe& keyframe : keyframes) path.poses.push_back({path.header, ros2::to_pose(keyframe.T_map_base)});
  topics_->path.write(path);
  drawing_now_->store(true);
  drawing_.run([draw = std::move(draw), stamp, frame = link_->map_frame, topics = topics_, now = drawing_now_] {
    const ros2::OccupancyGrid grid = ros2::to_grid(draw(), stamp, frame);
    topics->map.write(grid);
    topics->map_metadata.write(grid.info);
    now->store(false);
  });
}

void LivePublisher::publish_diagnostics(const live::LiveUpdate& live) {
  const Stamp now = live::system_ns();
  if (!ros2::due(last_diagnostics_, now, kDiagnosticsPeriod_s)) return;
  last_diagnostics_ = now;
  const std::lock_guard lock(link_->mutex);
  topics_->diagnostics.write(
      link_->told.report(now, to_string(live.update.status),
                         {{"scans", std::to_string(scans_)},
                          {"left_out", std::to_string(live.dropped)},
                          {"latency_ms", fmt::format("{:.2f}", live.latency_ms)},
                          {"odometry", live.measurement->T_odom_base ? "used" : "none: published here"}}));
}

void LivePublisher::take_poses() {
  for (;;) {
    try {
      const auto message = topics_->initial_pose.take();
      if (!message) return;
      set_pose_(ros2::to_pose2(message->pose.pose), ros2::to_covariance3(message->pose.covariance));
    } catch (const std::exception& error) {
      const std::lock_guard lock(link_->mutex);
      link_->told.note(ros2::Trouble::kBadPose, live::system_ns(), error.what());
    }
  }
}

}  // namespace phasescan::dds
