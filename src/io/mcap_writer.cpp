#include "io/mcap_writer.hpp"

#include "io/mcap_file.hpp"
#include "io/ros_encode.hpp"

namespace phasescan {

struct McapWriter::Impl {
  explicit Impl(const std::string& path) : file(path) {}

  template <class Message>
  void add(const std::string& topic, const std::string& type, Stamp stamp, const Message& message) {
    body.clear();
    ros::encode(message, body);
    file.add(topic, type, stamp, Bytes(body.bytes()));
  }

  McapFile file;
  ByteWriter body;
};

McapWriter::McapWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
McapWriter::~McapWriter() = default;
McapWriter::McapWriter(McapWriter&&) noexcept = default;
McapWriter& McapWriter::operator=(McapWriter&&) noexcept = default;

void McapWriter::scan(const std::string& topic, const std::string& frame, const Scan& scan, double scan_seconds) {
  impl_->add(topic, "sensor_msgs/msg/LaserScan", scan.stamp, ros::from_scan(scan, frame, scan_seconds));
}

void McapWriter::odometry(const std::string& topic, Stamp stamp, const std::string& frame, const std::string& child,
                          const Pose2& pose) {
  impl_->add(topic, "nav_msgs/msg/Odometry", stamp, ros::Odometry{{stamp, frame}, child, ros::spatial(pose)});
}

void McapWriter::transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                           bool flipped) {
  impl_->add("/tf", "tf2_msgs/msg/TFMessage", stamp,
             std::vector<ros::Transform>{{{stamp, frame}, child, ros::spatial(pose, flipped)}});
}

void McapWriter::static_transform(Stamp stamp, const std::string& frame, const std::string& child, const Pose2& pose,
                                  bool flipped) {
  impl_->add("/tf_static", "tf2_msgs/msg/TFMessage", stamp,
             std::vector<ros::Transform>{{{stamp, frame}, child, ros::spatial(pose, flipped)}});
}

void McapWriter::path(const std::string& topic, Stamp stamp, const std::string& frame,
                      std::span<const std::pair<Stamp, Pose2>> poses) {
  std::vector<ros::PathPoint> points;
  points.reserve(poses.size());
  for (const auto& [at, pose] : poses) points.push_back({at, pose});
  impl_->add(topic, "nav_msgs/msg/Path", stamp, ros::Path{{stamp, frame}, points});
}

void McapWriter::grid(const std::string& topic, Stamp stamp, const std::string& frame, const McapGrid& grid) {
  impl_->add(topic, "nav_msgs/msg/OccupancyGrid", stamp,
             ros::OccupancyGrid{{stamp, frame},
                                static_cast<float>(grid.resolution_m),
                                grid.width,
                                grid.height,
                                grid.T_map_origin,
                                grid.cells});
}

void McapWriter::close() {
  impl_->file.finish();
}

}  // namespace phasescan
