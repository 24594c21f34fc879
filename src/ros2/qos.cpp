#include "ros2/qos.hpp"

#include <stdexcept>
#include <string>

#include "ros2/messages.hpp"

namespace phasescan::ros2 {
namespace {

constexpr Qos kSensorData{false, false, 10};
constexpr Qos kReliable{true, false, 10};
constexpr Qos kLatched{true, true, 1};

template <class M>
constexpr std::string_view kType = Message<M>::type;

constexpr Endpoint kSlam[] = {
    {Role::kSlam, Direction::kIn, "scan", kType<LaserScan>, kSensorData},
    {Role::kSlam, Direction::kIn, "odom", kType<Odometry>, kSensorData},
    {Role::kSlam, Direction::kIn, "/tf", kType<TFMessage>, {true, false, 100}},
    {Role::kSlam, Direction::kIn, "/tf_static", kType<TFMessage>, {true, true, 100}},
    {Role::kSlam, Direction::kOut, "map", kType<OccupancyGrid>, kLatched},
    {Role::kSlam, Direction::kOut, "map_metadata", kType<MapMetaData>, kLatched},
    {Role::kSlam, Direction::kOut, "pose", kType<PoseWithCovarianceStamped>, kReliable},
    {Role::kSlam, Direction::kOut, "path", kType<Path>, kLatched},
    {Role::kSlam, Direction::kOut, "status", kType<String>, kLatched},
    {Role::kSlam, Direction::kOut, "/tf", kType<TFMessage>, {true, false, 100}},
    {Role::kSlam, Direction::kOut, "/diagnostics", kType<DiagnosticArray>, kReliable},
};
constexpr Endpoint kLocalization[] = {
    {Role::kLocalization, Direction::kIn, "scan", kType<LaserScan>, kSensorData},
    {Role::kLocalization, Direction::kIn, "odom", kType<Odometry>, kSensorData},
    {Role::kLocalization, Direction::kIn, "map", kType<OccupancyGrid>, {true, true, 3}},
    {Role::kLocalization, Direction::kIn, "/tf", kType<TFMessage>, {true, false, 100}},
    {Role::kLocalization, Direction::kIn, "/tf_static", kType<TFMessage>, {true, true, 100}},
    {Role::kLocalization, Direction::kIn, "initialpose", kType<PoseWithCovarianceStamped>, kReliable},
    {Role::kLocalization, Direction::kOut, "amcl_pose", kType<PoseWithCovarianceStamped>, kLatched},
    {Role::kLocalization, Direction::kOut, "particle_cloud", kType<ParticleCloud>, kSensorData},
    {Role::kLocalization, Direction::kOut, "status", kType<String>, kLatched},
    {Role::kLocalization, Direction::kOut, "/tf", kType<TFMessage>, {true, false, 100}},
    {Role::kLocalization, Direction::kOut, "/diagnostics", kType<DiagnosticArray>, kReliable},
};

}  // namespace

std::span<const Endpoint> endpoints(Role role) {
  return role == Role::kSlam ? std::span<const Endpoint>(kSlam) : std::span<const Endpoint>(kLocalization);
}

const Endpoint& endpoint(Role role, Direction direction, std::string_view name) {
  for (const Endpoint& endpoint : endpoints(role)) {
    if (endpoint.direction == direction && endpoint.name == name) return endpoint;
  }
  throw std::invalid_argument("topic: this node has none that is called '" + std::string(name) + "'");
}

bool compatible(const Qos& offered, const Qos& asked) {
  return (offered.reliable || !asked.reliable) && (offered.transient_local || !asked.transient_local);
}

}  // namespace phasescan::ros2
