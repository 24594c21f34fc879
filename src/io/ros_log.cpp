#include "io/ros_log.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/decompress.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::ros {
namespace {

constexpr Stamp kSecond = 1'000'000'000;
constexpr Stamp kLongestWait = 2 * kSecond;
constexpr std::size_t kMostPending = 64;
constexpr std::size_t kMostSamples = 4096;
constexpr std::size_t kMostChannels = 4096;
constexpr Stamp kLongestGap = kSecond;
constexpr Stamp kNearest = kSecond / 5;

/// "sensor_msgs/msg/LaserScan" and "sensor_msgs/LaserScan" are one type.
std::string plain_type(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

Channel::Content content_of(const std::string& type) {
  const std::string plain = plain_type(type);
  if (plain == "sensor_msgs/LaserScan") return Channel::Content::kScan;
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
  Channel made{topic, type, wire, content_of(type), 0};
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
  decode(channel.wire, data, scan_message_);
  Pending pending;
  pending.entry.scan = to_scan(scan_message_);
  if (scan_message_.time_increment != 0.0F && pending.entry.scan.time_increment == 0.0) ++absurd_time_increments_;
  pending.entry.laser = channel.topic;
  pending.entry.line = ordinal_;
  pending.frame = plain_frame(scan_message_.header.frame_id);
  pending.log_time = log_time;
  pending_.push_back(std::move(pending));
}

void RosLogReader::add_odometry(const Channel& channel, Bytes data) {
  if (odometry_topic_.empty() && !source_settled_) odometry_topic_ = channel.topic;
  if (channel.topic != odometry_topic_) return;
  decode(channel.wire, data, odometry_message_);
  base_frame_ = plain_frame(odometry_message_.child_frame_id);
  add_sample(samples_, {odometry_message_.header.stamp, planar(odometry_message_.pose)});
}

void RosLogReader::add_transforms(const Channel& channel, Bytes data) {
  decode(channel.wire, data, transforms_);
  for (const Transform& transform : transforms_) {
    tree_.add(transform);
    if (!is_odom_frame(plain_frame(transform.header.frame_id))) continue;
    const std::string child = plain_frame(transform.child_frame_id);
    if (tf_base_frame_.empty()) tf_base_frame_ = child;
    if (child == tf_base_frame_) add_sample(tf_samples_, {transform.header.stamp, planar(transform.pose)});
  }
}

void RosLogReader::add_sample(std::deque<Sample>& samples, Sample sample) {
  if (!samples.empty() && sample.stamp <= samples.back().stamp) {
    if (samples.back().stamp - sample.stamp < kSecond) return;
    samples.clear();  // the clock was set back: what came before belongs to another time
  }
  samples.push_back(sample);
  if (samples.size() > kMostSamples) samples.pop_front();
}

bool RosLogReader::may_leave(const Pending& pending) const {
  if (ended_ || pending_.size() >= kMostPending || log_time_ - pending.log_time > kLongestWait) return true;
  if (log_time_ < pending.log_time) return true;  // recorded out of order: waiting longer tells nothing
  const std::deque<Sample>& samples = odometry();
  if (samples.empty() || samples.back().stamp < pending.entry.scan.stamp) return false;
  return mountings_.contains(pending.frame) || tree_.mounting(base_frame(), pending.frame).has_value();
}

std::optional<Pose2> RosLogReader::odometry_at(Stamp stamp) const {
  const std::deque<Sample>& samples = odometry();
  const auto after = std::lower_bound(samples.begin(), samples.end(), stamp,
                                      [](const Sample& sample, Stamp t) { return sample.stamp < t; });
  if (after != samples.end() && after->stamp == stamp) return after->pose;
  if (after != samples.end() && after != samples.begin()) {
    const Sample& before = *std::prev(after);
    if (after->stamp - before.stamp <= kLongestGap) {
      const double share = static_cast<double>(stamp - before.stamp) / static_cast<double>(after->stamp - before.stamp);
      const Pose2& a = before.pose;
      const Pose2& b = after->pose;
      return Pose2{a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
                   wrap_angle(a.theta + share * wrap_angle(b.theta - a.theta))};
    }
  }
  const auto near = [stamp](const Sample& sample) {
    const Stamp away = sample.stamp > stamp ? sample.stamp - stamp : stamp - sample.stamp;
    return away <= kNearest ? away : kNearest + 1;
  };
  const Stamp to_after = after != samples.end() ? near(*after) : kNearest + 1;
  const Stamp to_before = after != samples.begin() ? near(*std::prev(after)) : kNearest + 1;
  if (std::min(to_after, to_before) > kNearest) return std::nullopt;
  return to_after < to_before ? after->pose : std::prev(after)->pose;
}

std::optional<LogEntry> RosLogReader::next() {
  while (pending_.empty() || !may_leave(pending_.front())) {
    if (ended_) break;
    ended_ = !container_->read_more();
  }
  if (pending_.empty()) {
    check_topic();
    return std::nullopt;
  }
  Pending pending = std::move(pending_.front());
  pending_.pop_front();
  LogEntry& entry = pending.entry;
  // From the first scan on the kind of odometry stays: a change of frame would look like a jump of the robot.
  if (!odometry().empty()) source_settled_ = true;
  entry.odometry = odometry_at(entry.scan.stamp);
  auto settled = mountings_.find(pending.frame);
  if (settled == mountings_.end() && mountings_.size() < kMostChannels) {
    settled = mountings_.emplace(pending.frame, tree_.mounting(base_frame(), pending.frame)).first;
  }
  if (settled != mountings_.end() && settled->second) {
    entry.T_base_laser = settled->second->T_base_laser;
    entry.flipped = settled->second->flipped;
  }
  return std::move(pending.entry);
}

void RosLogReader::check_topic() const {
  if (topic_.empty()) return;
  std::string others;
  for (const auto& [key, channel] : channels_) {
    if (channel.content != Channel::Content::kScan) continue;
    if (channel.topic == topic_) return;
    others += (others.empty() ? "" : ", ") + channel.topic;
  }
  throw InputError(path_, 0,
                   "no scans on topic " + topic_ + "; " +
                       (others.empty() ? "the log has no LaserScan topic" : "expected one of " + others));
}

std::map<std::string, std::string> RosLogReader::facts() const {
  std::map<std::string, std::string> out;
  container_->add_facts(out);
  for (const auto& [key, channel] : channels_) {
    out["topic " + channel.topic] = channel.type + ", " + std::to_string(channel.messages) + " messages";
  }
  if (absurd_time_increments_ > 0) {
    out["time_increment absurd"] =
        std::to_string(absurd_time_increments_) + " scans state a turn of more than 2 s or less than none";
  }
  if (!odometry_topic_.empty()) {
    out["odometry from"] = odometry_topic_;
  } else if (!tf_samples_.empty()) {
    out["odometry from"] = "the transform to " + tf_base_frame_;
  }
  for (const auto& [frame, mounting] : mountings_) {
    if (!mounting) {
      out["mounting of " + frame] = "not in the log: taken as the robot's own frame";
      continue;
    }
    const Pose2& pose = mounting->T_base_laser;
    out["mounting of " + frame] = fmt::format("x {:.3f} m, y {:.3f} m, heading {:.1f} deg{}{}", pose.x, pose.y,
                                              pose.theta * 180.0 / kPi, mounting->flipped ? ", upside down" : "",
                                              mounting->tilt_rad > 0.1 ? ", tilted out of the plane" : "");
  }
  return out;
}

}  // namespace phasescan::ros
