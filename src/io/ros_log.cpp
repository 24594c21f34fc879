#include "io/ros_log.hpp"

#include <algorithm>
#include <cmath>

#include "io/decompress.hpp"
#include "io/foxglove_scan.hpp"

namespace phasescan::ros {
namespace {

constexpr Stamp kSecond = 1'000'000'000;
constexpr Stamp kLongestWait = 2 * kSecond;
constexpr std::size_t kMostPending = 64;
constexpr std::size_t kMostChannels = 4096;
constexpr std::size_t kMostFramesOfATopic = 64;
constexpr double kTilted_rad = 0.1;  ///< a wall 5 m away is then met half a metre too high or low

/// "sensor_msgs/msg/LaserScan" and "sensor_msgs/LaserScan" are one type.
std::string plain_type(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

Channel::Content content_of(const std::string& type) {
  const std::string plain = plain_type(type);
  if (plain == "sensor_msgs/LaserScan") return Channel::Content::kScan;
  if (plain == "sensor_msgs/MultiEchoLaserScan") return Channel::Content::kMultiEcho;
  if (plain == "foxglove.LaserScan") return Channel::Content::kFoxglove;
  if (plain == "nav_msgs/Odometry") return Channel::Content::kOdometry;
  if (plain == "tf2_msgs/TFMessage" || plain == "tf/tfMessage") return Channel::Content::kTransforms;
  return Channel::Content::kOther;
}

/// odom, robot1/odom, odom_combined: the frames whose child is the robot by its own reckoning.
bool is_odom_frame(const std::string& frame) {
  const std::string last = frame.substr(frame.find_last_of('/') + 1);
  return last == "odom" || last == "odom_combined";
}

}  // namespace

Channel* RosLogReader::channel(const std::string& topic, const std::string& type, Wire wire) {
  const auto found = channels_.find(topic + "\n" + type);
  if (found != channels_.end()) return &found->second;
  if (channels_.size() >= kMostChannels) throw DecodeError("more than " + std::to_string(kMostChannels) + " topics");
  Channel made{topic, type, wire, content_of(type), 0, {}, {}, Channel::Stamps::kUnknown, 0};
  return &channels_.emplace(topic + "\n" + type, std::move(made)).first->second;
}

void RosLogReader::bad_message(const std::string& topic, const std::string& why) {
  ++ordinal_;
  add_damage("bad message", path_ + ": message " + std::to_string(ordinal_) + " of " + topic + ": " + why);
}

void RosLogReader::message(Channel& channel, Stamp log_time, Bytes data) {
  ++ordinal_;
  ++channel.messages;
  log_time_ = log_time;
  try {
    switch (channel.content) {
      case Channel::Content::kScan:
      case Channel::Content::kMultiEcho:
      case Channel::Content::kFoxglove:
        add_scan(channel, log_time, data);
        break;
      case Channel::Content::kOdometry:
        add_odometry(channel, data);
        break;
      case Channel::Content::kTransforms:
        add_transforms(channel, data);
        break;
      case Channel::Content::kOther:
        break;
    }
  } catch (const DecodeError& error) {
    add_damage("bad message", path_ + ": message " + std::to_string(ordinal_) + " of " + channel.topic + " is no " +
                                  channel.type + ": " + error.what());
  }
}

void RosLogReader::maybe_packed_message(Channel& channel, Stamp log_time, Bytes data) {
  if (!wanted(channel) || sniff_compression(data) != Compression::kZstd) {
    message(channel, log_time, data);
    return;
  }
  try {
    message(channel, log_time, zstd_unpack(data, message_limit(data.size())));
  } catch (const DecodeError& error) {
    bad_message(channel.topic, error.what());
  }
}

void RosLogReader::add_scan(Channel& channel, Stamp log_time, Bytes data) {
  if (!topic_.empty() && channel.topic != topic_) return;
  decode_scan(channel, data);
  Pending pending;
  pending.frame = plain_frame(scan_message_.header.frame_id);
  if (channel.frames.size() < kMostFramesOfATopic || channel.frames.contains(pending.frame))
    ++channel.frames[pending.frame];
  if (!frame_.empty() && pending.frame != frame_) return;
  pending.entry.scan = channel.reading.read(scan_message_);
  pending.entry.laser = channel.topic;
  pending.entry.line = ordinal_;
  pending.channel = &channel;
  pending.log_time = log_time;
  settle_stamp(pending);
  pending_.push_back(std::move(pending));
}

void RosLogReader::decode_scan(const Channel& channel, Bytes data) {
  if (channel.content == Channel::Content::kFoxglove) {
    decode_foxglove(channel.wire, data, scan_message_);
  } else if (channel.content == Channel::Content::kMultiEcho) {
    decode_multi_echo(channel.wire, data, scan_message_);
  } else {
    decode(channel.wire, data, scan_message_);
  }
}

void RosLogReader::settle_stamp(Pending& pending) {
  Channel& channel = *pending.channel;
  if (channel.stamps == Channel::Stamps::kUnknown) {
    if (pending.entry.scan.stamp != 0) {
      channel.stamps = Channel::Stamps::kStated;
    } else if (++channel.zero_stamps > 1) {
      channel.stamps = Channel::Stamps::kZero;
      for (Pending& other : pending_) {
        if (other.channel == &channel) other.entry.scan.stamp = other.log_time;
      }
    }
  }
  if (channel.stamps == Channel::Stamps::kZero && pending.entry.scan.stamp == 0)
    pending.entry.scan.stamp = pending.log_time;
}

void RosLogReader::add_odometry(const Channel& channel, Bytes data) {
  if (odometry_topic_.empty() && !source_settled_) odometry_topic_ = channel.topic;
  if (channel.topic != odometry_topic_) return;
  decode(channel.wire, data, odometry_message_);
  base_frame_ = plain_frame(odometry_message_.child_frame_id);
  Stamp stamp = odometry_message_.header.stamp;
  if (stamp == 0 && ++zero_odometry_ > 1) {
    if (zero_odometry_ == 2) samples_.clear();
    stamp = log_time_;
  }
  samples_.add({stamp, planar(odometry_message_.pose)});
}

void RosLogReader::add_transforms(const Channel& channel, Bytes data) {
  decode(channel.wire, data, transforms_);
  for (const Transform& transform : transforms_) {
    tree_.add(transform);
    if (!is_odom_frame(plain_frame(transform.header.frame_id))) continue;
    const std::string child = plain_frame(transform.child_frame_id);
    if (tf_base_frame_.empty()) tf_base_frame_ = child;
    if (child == tf_base_frame_) tf_samples_.add({transform.header.stamp, planar(transform.pose)});
  }
}

bool RosLogReader::may_leave(const Pending& pending) const {
  if (ended_ || pending_.size() >= kMostPending || log_time_ - pending.log_time > kLongestWait) return true;
  if (pending.channel->stamps == Channel::Stamps::kUnknown) return false;
  if (log_time_ < pending.log_time) return true;  // recorded out of order: waiting longer tells nothing
  const OdometrySamples& samples = odometry();
  if (samples.empty() || samples.last_stamp() < pending.entry.scan.stamp) return false;
  return mountings_.contains(pending.frame) || tree_.mounting(base_frame(), pending.frame).has_value();
}

std::optional<LogEntry> RosLogReader::next() {
  for (;;) {
    while (pending_.empty() || !may_leave(pending_.front())) {
      if (ended_) break;
      ended_ = !container_->read_more();
    }
    if (pending_.empty()) {
      check_topic();
      check_frame();
      return std::nullopt;
    }
    Pending pending = std::move(pending_.front());
    pending_.pop_front();
    place_on_robot(pending);
    if (!is_left_out(pending)) return std::move(pending.entry);
  }
}

void RosLogReader::place_on_robot(Pending& pending) {
  LogEntry& entry = pending.entry;
  // From the first scan on the kind of odometry stays: a change of frame would look like a jump of the robot.
  if (!odometry().empty()) source_settled_ = true;
  entry.odometry = odometry().near(entry.scan.stamp);
  clock_.add(entry.scan.stamp, entry.odometry.has_value(), odometry());
  auto settled = mountings_.find(pending.frame);
  if (settled == mountings_.end() && mountings_.size() < kMostChannels) {
    settled = mountings_.emplace(pending.frame, tree_.mounting(base_frame(), pending.frame)).first;
  }
  if (settled != mountings_.end() && settled->second) {
    entry.T_base_laser = settled->second->T_base_laser;
    entry.flipped = settled->second->flipped;
  }
}

bool RosLogReader::is_left_out(const Pending& pending) {
  const auto settled = mountings_.find(pending.frame);
  if (!frame_.empty() || settled == mountings_.end() || !settled->second || settled->second->tilt_rad <= kTilted_rad)
    return false;
  ++tilted_[pending.frame];
  return true;
}

}  // namespace phasescan::ros
