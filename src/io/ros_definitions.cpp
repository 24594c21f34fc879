// The message types that are written, as a reader needs them told: form "ros2msg".
#include <algorithm>
#include <stdexcept>

#include "io/ros_encode.hpp"

namespace phasescan::ros {
namespace {

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
    {"geometry_msgs/msg/PoseWithCovarianceStamped", "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
     "std_msgs/Header builtin_interfaces/Time geometry_msgs/PoseWithCovariance geometry_msgs/Pose geometry_msgs/Point "
     "geometry_msgs/Quaternion"},
    {"std_msgs/msg/String", "string data\n", ""},
    {"diagnostic_msgs/msg/DiagnosticArray", "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
     "std_msgs/Header builtin_interfaces/Time diagnostic_msgs/DiagnosticStatus diagnostic_msgs/KeyValue"},
    {"diagnostic_msgs/DiagnosticStatus",
     "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n"
     "string hardware_id\ndiagnostic_msgs/KeyValue[] values\n",
     ""},
    {"diagnostic_msgs/KeyValue", "string key\nstring value\n", ""},
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
