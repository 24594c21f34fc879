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

void encode(const PoseEstimate& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.header(message.header);
  cdr.pose(spatial(message.pose));
  // Of (x, y, z, roll, pitch, yaw); height, roll and pitch are exact: they are 0.
  double full[6][6] = {};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) full[kPlanar[row]][kPlanar[column]] = message.covariance(row, column);
  }
  for (const auto& row : full) {
    for (const double value : row) cdr.put(value);
  }
}

void encode(const Text& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.text(message.data);
}

void encode(const Diagnostics& message, ByteWriter& out) {
  CdrWriter cdr(out);
  cdr.header(message.header);
  cdr.put(std::uint32_t{1});
  cdr.put(static_cast<std::uint8_t>(message.level));
  for (const std::string& text : {message.name, message.message, message.hardware_id}) cdr.text(text);
  cdr.put(static_cast<std::uint32_t>(message.values.size()));
  for (const auto& [key, value] : message.values) {
    cdr.text(key);
    cdr.text(value);
  }
}

}  // namespace phasescan::ros
