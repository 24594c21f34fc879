#include "serve/frames.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

namespace phasescan::serve {
namespace {

constexpr std::size_t kMostPoints = 2000;  // of a scan; more nobody sees
constexpr double kUnitM = 0.005;           // of a point's coordinates: 16 bits reach 160 m

static_assert(std::endian::native == std::endian::little, "frames are little endian");

template <class T>
void put(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

void put_float(std::string& out, double value) {
  put(out, static_cast<float>(value));
}

void put_header(std::string& out, FrameKind kind) {
  put(out, static_cast<std::uint8_t>(kind));
  out.append(3, '\0');
}

std::int16_t in_units(double metres) {
  return static_cast<std::int16_t>(std::clamp(std::round(metres / kUnitM), -32767.0, 32767.0));
}

/// A finite number of a JSON object, or nothing.
std::optional<double> number(const nlohmann::json& json, const char* name) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) && std::abs(value) <= 1e6 ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string scan_frame(const live::LiveUpdate& live, bool deskew) {
  const ScanUpdate& update = live.update;
  const Pose2 pose = update.T_map_base();
  const Eigen::Matrix3d covariance = update.map_covariance.value_or(update.odom_covariance);
  std::string out;
  put(out, static_cast<std::uint8_t>(FrameKind::kScan));
  put(out, static_cast<std::uint8_t>(update.status));
  put(out, static_cast<std::uint16_t>(live.on_map ? 0 : 1));
  const std::size_t count_at = out.size();
  put(out, std::uint32_t{0});
  put(out, stamp_to_seconds(update.stamp));
  for (const double value : {pose.x, pose.y, pose.theta, covariance(0, 0), covariance(0, 1), covariance(1, 1),
                             covariance(2, 2), live.confidence, live.latency_ms, kUnitM})
    put_float(out, value);
  if (!live.measurement) return out;
  const Scan& scan = live.measurement->scan;
  const Pose2& T_base_laser = live.measurement->T_base_laser;
  const Twist2 twist = deskew && is_tracked(update.status) ? update.twist : Twist2{};
  const std::size_t step = 1 + scan.size() / kMostPoints;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < scan.size(); i += step) {
    if (!scan.is_hit(i)) continue;
    const double range = static_cast<double>(scan.ranges[i]);
    const Eigen::Vector2d in_laser(range * std::cos(scan.angle(i)), range * std::sin(scan.angle(i)));
    const Eigen::Vector2d at =
        exp_twist(twist, static_cast<double>(i) * scan.time_increment) * (T_base_laser * in_laser);
    put(out, in_units(at.x()));
    put(out, in_units(at.y()));
    ++count;
  }
  std::memcpy(out.data() + count_at, &count, sizeof count);
  return out;
}

std::string begin_tiles(double resolution_m) {
  std::string out;
  put_header(out, FrameKind::kTiles);
  put_float(out, resolution_m);
  return out;
}

void add_tile(std::string& frame, TileIndex at, const PackedTile& tile) {
  put(frame, static_cast<std::int32_t>(at.first));
  put(frame, static_cast<std::int32_t>(at.second));
  put(frame, static_cast<std::uint32_t>(tile.size()));
  frame += tile;
}

std::string path_frame(std::span<const PathNode> nodes, std::size_t first) {
  std::string out;
  put_header(out, FrameKind::kPath);
  put(out, static_cast<std::uint32_t>(first));
  for (std::size_t i = first; i < nodes.size(); ++i) {
    put_float(out, nodes[i].T_map_base.x);
    put_float(out, nodes[i].T_map_base.y);
  }
  return out;
}

std::string loops_frame(std::span<const std::pair<std::int32_t, std::int32_t>> loops) {
  std::string out;
  put_header(out, FrameKind::kLoops);
  for (const auto& [from, to] : loops) {
    put(out, from);
    put(out, to);
  }
  return out;
}

std::string hypotheses_frame(const live::LiveUpdate& live) {
  std::string out;
  put_header(out, FrameKind::kHypotheses);
  if (!live.located || live.located->hypotheses.size() < 2) return out;
  for (const PoseEstimate& at : live.located->hypotheses)
    for (const double value : {at.T_map_base.x, at.T_map_base.y, at.T_map_base.theta, at.confidence})
      put_float(out, value);
  return out;
}

std::optional<ViewerCommand> parse_command(std::string_view text, std::string& why) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  const auto what = json.is_object() ? json.find("do") : json.end();
  if (!json.is_object() || what == json.end() || !what->is_string()) {
    why = "expected {\"do\": .., ..}";
    return std::nullopt;
  }
  ViewerCommand command;
  command.what = what->get<std::string>();
  if (const auto id = json.find("id"); id != json.end() && id->is_number_integer())
    command.id = id->get<std::int64_t>();
  if (const auto name = json.find("name"); name != json.end() && name->is_string())
    command.name = name->get<std::string>();
  if (command.what == "set_pose") {
    const auto x = number(json, "x"), y = number(json, "y"), theta = number(json, "theta");
    if (!x || !y || !theta) {
      why = "set_pose: expected x, y, theta";
      return std::nullopt;
    }
    command.pose = Pose2{*x, *y, wrap_angle(*theta)};
  } else if (command.what == "speed" || command.what == "seek") {
    const auto value = number(json, "value");
    const double most = command.what == "seek" ? 1.0 : 100.0;
    if (!value || *value < 0.0 || *value > most) {
      why = command.what + ": expected a value from 0 to " + (command.what == "seek" ? "1" : "100");
      return std::nullopt;
    }
    command.value = *value;
  }
  return command;
}

}  // namespace phasescan::serve
