/// Topics of both nodes with their quality of service: what a node in place of slam_toolbox or amcl must offer and ask.
#pragma once

#include <span>
#include <string_view>

namespace phasescan::ros2 {

enum class Role { kSlam, kLocalization };
enum class Direction { kIn, kOut };

struct Qos {
  bool reliable = true;          ///< else best effort
  bool transient_local = false;  ///< latecomers get the last `depth` messages; else volatile
  int depth = 10;                ///< keep last
  bool operator==(const Qos&) const = default;
};

struct Endpoint {
  Role role;
  Direction direction;
  std::string_view name;  ///< relative: put under the node's namespace, remappable; with "/": as it is
  std::string_view type;  ///< "sensor_msgs/msg/LaserScan"
  Qos qos;
};

/// All topics of a role.
std::span<const Endpoint> endpoints(Role role);
/// @throws std::invalid_argument for a topic that the role does not have
const Endpoint& endpoint(Role role, Direction direction, std::string_view name);

/// Whether a reader that asks `asked` gets what a writer offers: DDS refuses a reliable reader of a best-effort writer,
/// and a transient-local reader of a volatile one.
bool compatible(const Qos& offered, const Qos& asked);

}  // namespace phasescan::ros2
