/// What all ROS containers share: messages in, laser scans with odometry and mounting out.
#pragma once

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/odometry_samples.hpp"
#include "io/ros_messages.hpp"
#include "io/ros_scan.hpp"
#include "io/ros_tf.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan::ros {

/// One stream of messages of a container. Obtained from RosLogReader::channel, which knows whether anyone wants it.
struct Channel {
  enum class Content { kOther, kScan, kMultiEcho, kFoxglove, kOdometry, kTransforms };
  /// One stamp of 0 may begin a simulation; two are a driver that stamps nothing.
  enum class Stamps { kUnknown, kStated, kZero };
  std::string topic;
  std::string type;  ///< as stated, e.g. "sensor_msgs/msg/LaserScan"
  Wire wire = Wire::kCdr;
  Content content = Content::kOther;
  std::size_t messages = 0;

  ScanReading reading;
  std::map<std::string, std::size_t> frames;  ///< scans by frame_id
  Stamps stamps = Stamps::kUnknown;
  std::size_t zero_stamps = 0;
};

/// Whether messages of a channel are scans.
inline bool gives_scans(const Channel& channel) {
  return channel.content == Channel::Content::kScan || channel.content == Channel::Content::kMultiEcho ||
         channel.content == Channel::Content::kFoxglove;
}

/// How large a message may become when it is unpacked [bytes]: bounded by what it is packed in.
constexpr std::size_t message_limit(std::size_t packed_bytes) {
  return std::min<std::size_t>(std::size_t{1} << 26, (std::size_t{1} << 20) + 1024 * packed_bytes);
}

/// Bytes of a file as messages.
class Container {
 public:
  virtual ~Container() = default;
  /// Hands over a message or a few, or moves past something else. false = there is nothing more.
  virtual bool read_more() = 0;
  virtual std::string format() const = 0;
  virtual void add_facts(std::map<std::string, std::string>&) const {}
};

/// A container hands over its messages in the file's order; this class gives each scan the odometry at its stamp and
/// the mounting of its laser.
///
/// A scan waits until odometry on both sides of its stamp is there, and the transform to its laser, but never longer
/// than two seconds of the log or 64 scans. The robot's odometry is a nav_msgs/Odometry topic (the first one) or, in a
/// log without any, the transform from an odom frame. It is interpolated between samples at most a second apart;
/// outside them the nearest counts for 0.2 s. Where a laser sits is settled with its first scan. Scans of a laser
/// tilted out of the plane are left out unless their frame is asked for; where a driver stamps nothing, the recorder's
/// times count.
class RosLogReader final : public LogReader {
 public:
  RosLogReader(std::string path, const LogOptions& options)
      : path_(std::move(path)), topic_(options.topic), frame_(plain_frame(options.frame)) {}
  /// What the messages come from; it feeds this reader and lives as long.
  void read_from(std::unique_ptr<Container> container) { container_ = std::move(container); }

  std::optional<LogEntry> next() override;
  std::string format() const override { return container_->format(); }
  std::map<std::string, std::string> facts() const override;
  std::vector<LogRemark> remarks() const override;

  /// @name For containers
  /// @{
  /// The channel of a topic, made at its first call. `type` with or without "/msg". @throws DecodeError for too many.
  Channel* channel(const std::string& topic, const std::string& type, Wire wire);
  /// A message of a channel, recorded at `log_time`. Where `wanted(channel)` is false the data may be left out.
  void message(Channel& channel, Stamp log_time, Bytes data);
  /// As `message`, for data that may be a zstd frame of the message: rosbag2's compression of single messages.
  void maybe_packed_message(Channel& channel, Stamp log_time, Bytes data);
  /// A message that could not even be handed over: damage that names its ordinal.
  void bad_message(const std::string& topic, const std::string& why);
  /// Damage of the container itself, at `place` ("FILE: byte 12").
  void damage(const std::string& kind, const std::string& place, const std::string& why) {
    add_damage(kind, place + ": " + why);
  }
  /// True where the content of such messages matters for the answer.
  static bool wanted(const Channel& channel) { return channel.content != Channel::Content::kOther; }
  /// @}

 private:
  struct Pending {
    LogEntry entry;
    Channel* channel = nullptr;
    std::string frame;
    Stamp log_time = 0;
  };
  void add_scan(Channel& channel, Stamp log_time, Bytes data);
  void decode_scan(const Channel& channel, Bytes data);
  void settle_stamp(Pending& pending);
  void place_on_robot(Pending& pending);
  bool is_left_out(const Pending& pending);
  void add_odometry(const Channel& channel, Bytes data);
  void add_transforms(const Channel& channel, Bytes data);
  const OdometrySamples& odometry() const { return odometry_topic_.empty() ? tf_samples_ : samples_; }
  bool may_leave(const Pending& pending) const;
  const std::string& base_frame() const { return odometry_topic_.empty() ? tf_base_frame_ : base_frame_; }
  void check_topic() const;
  void check_frame() const;

  std::string path_;
  std::string topic_, frame_;
  std::unique_ptr<Container> container_;
  std::map<std::string, Channel> channels_;
  LaserScan scan_message_;
  Odometry odometry_message_;
  std::vector<Transform> transforms_;
  std::deque<Pending> pending_;
  std::string odometry_topic_;
  bool source_settled_ = false;
  std::string base_frame_;     ///< child frame of the odometry topic
  std::string tf_base_frame_;  ///< child frame of the first odom transform
  OdometrySamples samples_;
  OdometrySamples tf_samples_;
  ClockCheck clock_;
  TransformTree tree_;
  std::map<std::string, std::optional<Mounting>> mountings_;
  std::map<std::string, std::size_t> tilted_;  ///< scans left out by frame
  std::size_t zero_odometry_ = 0;
  Stamp log_time_ = 0;
  long ordinal_ = 0;
  bool ended_ = false;
};

}  // namespace phasescan::ros
