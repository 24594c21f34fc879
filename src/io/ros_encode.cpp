#include "io/ros_encode.hpp"

#include <stdexcept>

#include "io/cdr.hpp"

namespace phasescan::ros {
namespace {

/// CDR with what ROS messages have in common.
class CdrWriter : public CdrOutput {
 public:
  using CdrOutput::CdrOutput;
  void header(const Header& header) {
    time(header.stamp);
    text(header.frame_id);
  }
  void time(Stamp stamp) {
    constexpr Stamp kSecond = 1'000'000'000;
    Stamp seconds = stamp / kSecond;
    Stamp rest = stamp % kSecond;
    if (rest < 0) {
      rest += kSecond;
      --seconds;
    }
    put(static_cast<std::int32_t>(seconds));
    put(static_cast<std::uint32_t>(rest));
  }
  void pose(const Pose3& pose) {
    for (int i = 0; i < 3; ++i) put(pose.translation[i]);
    for (const double value : {pose.rotation.x(), pose.rotation.y(), pose.rotation.z(), pose.rotation.w()}) put(value);
  }
};

struct Definition {
  std::string_view type;
  std::string_view fields;
  std::string_view parts;  ///< types it is made of, all levels, separated by blanks
};

constexpr Definition kDefinitions[] = {
    {"sensor_msgs/msg/LaserScan",
     "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n"
     "float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n",
     "std_msgs/Header builtin_interfaces/Time"},
    {"nav_msgs/msg/Odometry",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist\n",
     "std_msgs/Header builtin_interfaces/Time geometry_msgs/PoseWithCovariance geometry_msgs/TwistWithCovariance "
     "geometry_msgs/Pose geometry_msgs/Point geometry_msgs/Quaternion geometry_msgs/Twist geometry_msgs/Vector3"},
    {"tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms\n",
     "geometry_msgs/TransformStamped std_msgs/Header builtin_interfaces/Time geometry_msgs/Transform "
     "geometry_msgs/Vector3 geometry_msgs/Quaternion"},
    {"nav_msgs/msg/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
     "std_msgs/Header builtin_interfaces/Time nav_msgs/MapMetaData geometry_msgs/Pose geometry_msgs/Point "
     "geometry_msgs/Quaternion"},
    {"nav_msgs/msg/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
     "std_msgs/Header builtin_interfaces/Time geometry_msgs/PoseStamped geometry_msgs/Pose geometry_msgs/Point "
     "geometry_msgs/Quaternion"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n", ""},
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n", ""},
    {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n", ""},
    {"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n", ""},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n", ""},
    {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n", ""},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n", ""},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", ""},
    {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n", ""},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n", ""},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n", ""},
    {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n", ""},
    {"nav_msgs/MapMetaData",
     "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin\n",
     ""},
};

const Definition& definition_of(std::string_view type) {
  for (const Definition& definition : kDefinitions) {
    if (definition.type == type) return definition;
  }
  throw std::invalid_argument("message type '" + std::string(type) + "' has no definition");
}

}  // namespace

Pose3 spatial(const Pose2& pose, bool flipped) {
  Pose3 out;
  out.translation = {pose.x, pose.y, 0.0};
  out.rotation = Eigen::AngleAxisd(pose.theta, Eigen::Vector3d::UnitZ());
  if (flipped) out.rotation = out.rotation * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  return out;
}

void encode(const LaserScan& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.header(message.header);
  for (const float value : {message.angle_min, message.angle_max, message.angle_increment, message.time_increment,
                            message.scan_time, message.range_min, message.range_max}) {
    cdr.put(value);
  }
  cdr.sequence(std::span<const float>(message.ranges));
  cdr.sequence(std::span<const float>(message.intensities));
}

void encode(const Odometry& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.header(message.header);
  cdr.text(message.child_frame_id);
  cdr.pose(message.pose);
  cdr.zero_doubles(36 + 6 + 36);
}

void encode(const std::vector<Transform>& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.put(static_cast<std::uint32_t>(message.size()));
  for (const Transform& transform : message) {
    cdr.header(transform.header);
    cdr.text(transform.child_frame_id);
    cdr.pose(transform.pose);
  }
}

void encode(const OccupancyGrid& message, ByteWriter& out) {
  if (message.cells.size() != std::size_t{message.width} * message.height) {
    throw std::invalid_argument("occupancy_grid.cells: the count is not width * height");
  }
  CdrWriter cdr(out);
  cdr.header(message.header);
  cdr.time(message.header.stamp);
  cdr.put(message.resolution_m);
  cdr.put(message.width);
  cdr.put(message.height);
  cdr.pose(spatial(message.T_map_origin));
  cdr.sequence(message.cells);
}

void encode(const Path& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.header(message.header);
  cdr.put(static_cast<std::uint32_t>(message.points.size()));
  for (const PathPoint& point : message.points) {
    cdr.header({point.stamp, message.header.frame_id});
    cdr.pose(spatial(point.pose));
  }
}

std::string message_definition(std::string_view type) {
  const Definition& definition = definition_of(type);
  std::string out(definition.fields);
  std::string_view parts = definition.parts;
  while (!parts.empty()) {
    const std::string_view part = parts.substr(0, parts.find(' '));
    parts.remove_prefix(std::min(parts.size(), part.size() + 1));
    out += std::string(80, '=') + "\nMSG: " + std::string(part) + "\n" + std::string(definition_of(part).fields);
  }
  return out;
}

}  // namespace phasescan::ros
