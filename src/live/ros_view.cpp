#include "live/ros_view.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/even_scan.hpp"
#include "io/ros_encode.hpp"

namespace phasescan::live {
namespace {

constexpr std::string_view kTransforms = "tf2_msgs/msg/TFMessage", kLaserScan = "sensor_msgs/msg/LaserScan",
                           kGrid = "nav_msgs/msg/OccupancyGrid", kPath = "nav_msgs/msg/Path",
                           kPose = "geometry_msgs/msg/PoseWithCovarianceStamped", kText = "std_msgs/msg/String",
                           kDiagnostics = "diagnostic_msgs/msg/DiagnosticArray";

constexpr RosTopic kTopics[] = {{"/scan", kLaserScan, false},
                                {"/tf", kTransforms, false},
                                {"/tf_static", kTransforms, true},
                                {"/map", kGrid, true},
                                {"/path", kPath, true},
                                {"/pose", kPose, false},
                                {"/status", kText, true},
                                {"/diagnostics", kDiagnostics, true}};

constexpr std::size_t kMostPoses = 2000;

template <class Message>
RosMessage message_of(std::string_view topic, std::string_view type, Stamp stamp, const Message& message) {
  ByteWriter body;
  ros::encode(message, body);
  return {std::string(topic), std::string(type), stamp, body.bytes()};
}

ros::Diagnostics diagnostics_of(const LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  using Level = ros::Diagnostics::Level;
  const Level level = update.status == TrackingStatus::kOk     ? Level::kOk
                      : update.status == TrackingStatus::kLost ? Level::kError
                                                               : Level::kWarn;
  return {{update.stamp, ""},
          level,
          "phasescan: tracking",
          to_string(update.status),
          live.measurement->laser,
          {{"confidence", fmt::format("{:.3f}", live.confidence)},
           {"latency_ms", fmt::format("{:.2f}", live.latency_ms)},
           {"scans", std::to_string(update.scan + 1)},
           {"scans_dropped", std::to_string(live.dropped)},
           {"map_version", std::to_string(update.map_version)}}};
}

}  // namespace

std::span<const RosTopic> ros_topics() {
  return kTopics;
}

std::vector<RosMessage> RosView::of(const LiveUpdate& live) {
  const ScanUpdate& update = live.update;
  const RangeMeasurement& measurement = *live.measurement;
  const Stamp stamp = update.stamp;
  std::vector<RosMessage> out;
  if (update.repeated) return out;
  const auto [laser, is_new] = names_.of(measurement.laser);
  if (is_new) {
    const ros::Transform mounting{{stamp, "base_link"}, laser.frame, ros::spatial(measurement.T_base_laser)};
    out.push_back(message_of("/tf_static", kTransforms, stamp, std::vector<ros::Transform>{mounting}));
  }
  out.push_back(
      message_of(laser.topic, kLaserScan, stamp, ros::from_scan(even_scan(measurement.scan), laser.frame, 0.0)));
  std::vector<ros::Transform> frames{{{stamp, "odom"}, "base_link", ros::spatial(update.T_odom_base)}};
  // A map that grows begins where the robot stands; in one that is known nobody knows until the robot is found.
  if (!live.located || live.has_pose())
    frames.insert(frames.begin(), {{stamp, "map"}, "odom", ros::spatial(update.T_map_odom)});
  out.push_back(message_of("/tf", kTransforms, stamp, frames));
  if (live.has_pose()) {
    const Eigen::Matrix3d& covariance = update.map_covariance ? *update.map_covariance : update.odom_covariance;
    out.push_back(
        message_of("/pose", kPose, stamp, ros::PoseEstimate{{stamp, "map"}, update.T_map_base(), covariance}));
  }
  out.push_back(message_of("/status", kText, stamp, ros::Text{to_string(update.status)}));
  out.push_back(message_of("/diagnostics", kDiagnostics, stamp, diagnostics_of(live)));
  return out;
}

RosMessage map_message(Stamp stamp, const TrinaryMap& map) {
  std::vector<std::int8_t> cells(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), cells.begin(),
                 [](CellState state) { return static_cast<std::int8_t>(state); });
  return message_of("/map", kGrid, stamp,
                    ros::OccupancyGrid{{stamp, "map"},
                                       static_cast<float>(map.resolution_m),
                                       static_cast<std::uint32_t>(map.width),
                                       static_cast<std::uint32_t>(map.height),
                                       map.origin,
                                       cells});
}

RosMessage path_message(const LiveUpdate& live) {
  const Stamp stamp = live.update.stamp;
  const std::vector<MapKeyframe> keyframes = live.map->keyframes();
  const std::size_t step = keyframes.size() / kMostPoses + 1;
  std::vector<ros::PathPoint> points;
  points.reserve(keyframes.size() / step + 2);
  for (std::size_t i = 0; i < keyframes.size(); i += step) points.push_back({stamp, keyframes[i].T_map_base});
  if (live.has_pose()) points.push_back({stamp, live.update.T_map_base()});
  return message_of("/path", kPath, stamp, ros::Path{{stamp, "map"}, points});
}

}  // namespace phasescan::live
