/// The ROS 2 messages that a SLAM or localisation node takes and gives, as plain structs. Each is described once, field
/// by field in the order of the wire, by its `Message` below: encoding, decoding, ROS definitions and IDL come from it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/ros_messages.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan::ros2 {

using ros::Header;     // std_msgs/Header: stamp [ns since 1970], frame_id
using ros::LaserScan;  // sensor_msgs/LaserScan

/// What a message looks like: `type`, and `visit` that names its fields. A field of nanoseconds that is a
/// builtin_interfaces/Time on the wire goes through `v.time(name, value)`, every other through `v(name, value)`.
template <class T>
struct Message;

struct Point {
  double x = 0, y = 0, z = 0;
};
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
struct Vector3 {
  double x = 0, y = 0, z = 0;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseStamped {
  Header header;
  Pose pose;
};
using Covariance6 = std::array<double, 36>;  ///< of (x, y, z, rx, ry, rz), row-major
struct PoseWithCovariance {
  Pose pose;
  Covariance6 covariance{};
};
struct PoseWithCovarianceStamped {
  Header header;
  PoseWithCovariance pose;
};
struct Twist {
  Vector3 linear, angular;
};
struct TwistWithCovariance {
  Twist twist;
  Covariance6 covariance{};
};
struct Transform {
  Vector3 translation;
  Quaternion rotation;
};
struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Transform transform;
};
struct TFMessage {
  std::vector<TransformStamped> transforms;
};
struct Odometry {
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
};
struct Path {
  Header header;
  std::vector<PoseStamped> poses;
};
struct MapMetaData {
  Stamp map_load_time = 0;
  float resolution = 0;
  std::uint32_t width = 0, height = 0;
  Pose origin;
};
struct OccupancyGrid {
  Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;
};
struct KeyValue {
  std::string key, value;
};
struct DiagnosticStatus {
  enum Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };
  std::uint8_t level = kOk;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};
struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
};
struct Particle {
  Pose pose;
  double weight = 0;
};
struct ParticleCloud {
  Header header;
  std::vector<Particle> particles;
};
struct String {
  std::string data;
};

template <>
struct Message<Header> {
  static constexpr std::string_view type = "std_msgs/msg/Header";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v.time("stamp", m.stamp);
    v("frame_id", m.frame_id);
  }
};
template <>
struct Message<LaserScan> {
  static constexpr std::string_view type = "sensor_msgs/msg/LaserScan";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("angle_min", m.angle_min);
    v("angle_max", m.angle_max);
    v("angle_increment", m.angle_increment);
    v("time_increment", m.time_increment);
    v("scan_time", m.scan_time);
    v("range_min", m.range_min);
    v("range_max", m.range_max);
    v("ranges", m.ranges);
    v("intensities", m.intensities);
  }
};
template <>
struct Message<Point> {
  static constexpr std::string_view type = "geometry_msgs/msg/Point";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("x", m.x), v("y", m.y), v("z", m.z);
  }
};
template <>
struct Message<Quaternion> {
  static constexpr std::string_view type = "geometry_msgs/msg/Quaternion";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("x", m.x), v("y", m.y), v("z", m.z), v("w", m.w);
  }
};
template <>
struct Message<Vector3> {
  static constexpr std::string_view type = "geometry_msgs/msg/Vector3";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("x", m.x), v("y", m.y), v("z", m.z);
  }
};
template <>
struct Message<Pose> {
  static constexpr std::string_view type = "geometry_msgs/msg/Pose";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("position", m.position);
    v("orientation", m.orientation);
  }
};
template <>
struct Message<PoseStamped> {
  static constexpr std::string_view type = "geometry_msgs/msg/PoseStamped";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("pose", m.pose);
  }
};
template <>
struct Message<PoseWithCovariance> {
  static constexpr std::string_view type = "geometry_msgs/msg/PoseWithCovariance";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("pose", m.pose);
    v("covariance", m.covariance);
  }
};
template <>
struct Message<PoseWithCovarianceStamped> {
  static constexpr std::string_view type = "geometry_msgs/msg/PoseWithCovarianceStamped";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("pose", m.pose);
  }
};
template <>
struct Message<Twist> {
  static constexpr std::string_view type = "geometry_msgs/msg/Twist";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("linear", m.linear);
    v("angular", m.angular);
  }
};
template <>
struct Message<TwistWithCovariance> {
  static constexpr std::string_view type = "geometry_msgs/msg/TwistWithCovariance";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("twist", m.twist);
    v("covariance", m.covariance);
  }
};
template <>
struct Message<Transform> {
  static constexpr std::string_view type = "geometry_msgs/msg/Transform";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("translation", m.translation);
    v("rotation", m.rotation);
  }
};
template <>
struct Message<TransformStamped> {
  static constexpr std::string_view type = "geometry_msgs/msg/TransformStamped";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("child_frame_id", m.child_frame_id);
    v("transform", m.transform);
  }
};
template <>
struct Message<TFMessage> {
  static constexpr std::string_view type = "tf2_msgs/msg/TFMessage";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("transforms", m.transforms);
  }
};
template <>
struct Message<Odometry> {
  static constexpr std::string_view type = "nav_msgs/msg/Odometry";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("child_frame_id", m.child_frame_id);
    v("pose", m.pose);
    v("twist", m.twist);
  }
};
template <>
struct Message<Path> {
  static constexpr std::string_view type = "nav_msgs/msg/Path";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("poses", m.poses);
  }
};
template <>
struct Message<MapMetaData> {
  static constexpr std::string_view type = "nav_msgs/msg/MapMetaData";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v.time("map_load_time", m.map_load_time);
    v("resolution", m.resolution);
    v("width", m.width);
    v("height", m.height);
    v("origin", m.origin);
  }
};
template <>
struct Message<OccupancyGrid> {
  static constexpr std::string_view type = "nav_msgs/msg/OccupancyGrid";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("info", m.info);
    v("data", m.data);
  }
};
template <>
struct Message<KeyValue> {
  static constexpr std::string_view type = "diagnostic_msgs/msg/KeyValue";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("key", m.key);
    v("value", m.value);
  }
};
template <>
struct Message<DiagnosticStatus> {
  static constexpr std::string_view type = "diagnostic_msgs/msg/DiagnosticStatus";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("level", m.level);
    v("name", m.name);
    v("message", m.message);
    v("hardware_id", m.hardware_id);
    v("values", m.values);
  }
};
template <>
struct Message<DiagnosticArray> {
  static constexpr std::string_view type = "diagnostic_msgs/msg/DiagnosticArray";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("status", m.status);
  }
};
template <>
struct Message<Particle> {
  static constexpr std::string_view type = "nav2_msgs/msg/Particle";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("pose", m.pose);
    v("weight", m.weight);
  }
};
template <>
struct Message<ParticleCloud> {
  static constexpr std::string_view type = "nav2_msgs/msg/ParticleCloud";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("header", m.header);
    v("particles", m.particles);
  }
};
template <>
struct Message<String> {
  static constexpr std::string_view type = "std_msgs/msg/String";
  template <class S, class V>
  static void visit(S& m, V&& v) {
    v("data", m.data);
  }
};

/// Calls v.template operator()<M>() for each message that goes over a topic.
template <class V>
void for_each_topic_type(V&& v) {
  v.template operator()<LaserScan>();
  v.template operator()<TFMessage>();
  v.template operator()<Odometry>();
  v.template operator()<PoseStamped>();
  v.template operator()<PoseWithCovarianceStamped>();
  v.template operator()<Path>();
  v.template operator()<MapMetaData>();
  v.template operator()<OccupancyGrid>();
  v.template operator()<DiagnosticArray>();
  v.template operator()<ParticleCloud>();
  v.template operator()<String>();
}

}  // namespace phasescan::ros2
