#include "ros2/scan_intake.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/ros_tf.hpp"

namespace phasescan::ros2 {
namespace {

constexpr std::size_t kMostOwn = 256;
constexpr double kSame = 1e-9;

double seconds_between(Stamp early, Stamp late) {
  return stamp_to_seconds(late - early);
}

}  // namespace

void ScanIntake::add_scan(const std::string& topic, const LaserScan& message, Stamp now) {
  GatedScan gated = gate_.take(topic, message, now, told_);
  if (gated.clock_jumped_back) restart_at(gated.stamp);
  if (!gated.scan) return;
  if (options_.every > 1 && (skipped_[topic]++ % options_.every) != 0) return;
  const Stamp stamp = gated.scan->stamp;
  newest_[topic] = std::max(stamp, newest_.contains(topic) ? newest_[topic] : stamp);
  if (last_taken_ && stamp < *last_taken_) {
    told_.note(Trouble::kOutOfOrder, now, topic + ": a scan that came after newer ones of another laser were used");
    return;
  }
  const auto at = std::upper_bound(queue_.begin(), queue_.end(), stamp,
                                   [](Stamp wanted, const Waiting& other) { return wanted < other.scan.stamp; });
  queue_.insert(at, {topic, gated.frame, std::move(*gated.scan)});
}

void ScanIntake::push_out(const std::string& topic, Stamp now) {
  const auto oldest =
      std::find_if(queue_.begin(), queue_.end(), [&](const Waiting& scan) { return scan.topic == topic; });
  if (oldest == queue_.end()) return;
  queue_.erase(oldest);
  told_.note(Trouble::kQueueFull, now,
             fmt::format("{}: a scan waited for transforms until {} newer ones came", topic, kDepth));
}

bool ScanIntake::is_own(const TransformStamped& transform) const {
  return std::any_of(own_.begin(), own_.end(), [&](const auto& own) {
    const Vector3& at = transform.transform.translation;
    return own.first == transform.header.stamp && std::abs(own.second.x - at.x) < kSame &&
           std::abs(own.second.y - at.y) < kSame;
  });
}

void ScanIntake::add_transforms(const TFMessage& message, bool is_static, Stamp now) {
  TFMessage others;
  for (const TransformStamped& transform : message.transforms) {
    const bool of_base = !is_static && ros::plain_frame(transform.child_frame_id) == options_.base_frame;
    if (of_base && is_own(transform)) continue;
    if (of_base && !own_.empty()) {
      told_.note(Trouble::kOdometryConflict, now,
                 fmt::format("somebody else publishes {} -> {}; set odometry to tf, or stop that node",
                             transform.header.frame_id, options_.base_frame));
    }
    others.transforms.push_back(transform);
  }
  if (const std::size_t bad = transforms_.add(others, is_static); bad > 0)
    told_.note(Trouble::kBadTransform, now,
               fmt::format("{} transforms that are none: not finite, no rotation, or a frame on itself", bad));
}

void ScanIntake::add_odometry(const Odometry& message, Stamp now) {
  TransformStamped transform{{message.header.stamp, options_.odom_frame}, options_.base_frame, {}};
  const Point& at = message.pose.pose.position;
  transform.transform = {{at.x, at.y, at.z}, message.pose.pose.orientation};
  if (odometry_.add({{transform}}, false) > 0)
    told_.note(Trouble::kBadTransform, now, "an odometry message whose pose is none");
}

void ScanIntake::note_own_odometry(Stamp stamp, const Pose2& T_odom_base) {
  own_.emplace_back(stamp, T_odom_base);
  if (own_.size() > kMostOwn) own_.pop_front();
}

std::size_t ScanIntake::waiting_of(const std::string& topic) const {
  return static_cast<std::size_t>(
      std::count_if(queue_.begin(), queue_.end(), [&](const Waiting& scan) { return scan.topic == topic; }));
}

bool ScanIntake::other_lasers_are_past(const Waiting& scan) const {
  Stamp newest = scan.scan.stamp;
  for (const auto& [topic, stamp] : newest_) newest = std::max(newest, stamp);
  if (seconds_between(scan.scan.stamp, newest) > kWaitForLaser_s) return true;
  return std::all_of(newest_.begin(), newest_.end(), [&](const auto& laser) {
    return laser.first == scan.topic || laser.second >= scan.scan.stamp ||
           seconds_between(laser.second, scan.scan.stamp) > kLaserGone_s;
  });
}

ScanIntake::Readiness ScanIntake::mounting_of(const Waiting& scan, Stamp now) {
  Readiness out;
  out.ready = true;
  if (!options_.mounting_from_tf) return out;
  const TransformLookup lookup = transforms_.find(options_.base_frame, scan.frame, scan.scan.stamp);
  if (lookup.found == TransformFound::kFound) {
    const Eigen::Vector3d up = lookup.pose.rotation * Eigen::Vector3d::UnitZ();
    out.T_base_laser = ros::planar(lookup.pose);
    out.flipped = up.z() < 0.0;
    const double tilt = std::acos(std::clamp(std::abs(up.z()), 0.0, 1.0));
    if (tilt > kMostTilt_rad)
      told_.note(Trouble::kTiltedLaser, now,
                 fmt::format("{}: its plane is tilted by {:.0f} degrees", scan.frame, rad_to_deg(tilt)));
    return out;
  }
  out.ready = false;
  if (lookup.found == TransformFound::kTooEarly) {
    out.drop = true;
    told_.note(Trouble::kTransformGap, now,
               fmt::format("{} -> {}: the scan is older than the transforms kept", options_.base_frame, scan.frame));
    return out;
  }
  told_.note(Trouble::kScanBeforeTransform, now,
             fmt::format("{} -> {}: {} ({}); is robot_state_publisher running, or a static transform published?",
                         options_.base_frame, scan.frame, text_of(lookup.found), lookup.where));
  return out;
}

void ScanIntake::odometry_of(const Waiting& scan, Readiness& out, Stamp now) {
  const OdometrySource source = options_.odometry;
  if (source == OdometrySource::kNone) return;
  const TransformBuffer& buffer = source == OdometrySource::kTopic ? odometry_ : transforms_;
  const Stamp stamp = scan.scan.stamp;
  const TransformLookup lookup = buffer.find(options_.odom_frame, options_.base_frame, stamp);
  if (lookup.found == TransformFound::kFound) {
    out.T_odom_base = ros::planar(lookup.pose);
    odometry_seen_ = true;
    return;
  }
  const bool there = lookup.found == TransformFound::kTooLate || lookup.found == TransformFound::kTooEarly;
  const std::size_t waiting = waiting_of(scan.topic);
  if (there) {
    const std::optional<Stamp> newest = buffer.newest(lookup.where);
    const bool lost = newest && seconds_between(*newest, stamp) > kOdometryLost_s;
    if (lookup.found == TransformFound::kTooLate && !lost && waiting < kDepth) {
      out.ready = false;
      return;
    }
    told_.note(Trouble::kTransformGap, now,
               fmt::format("{} -> {} at a scan's time: {}; the scan is used without it", options_.odom_frame,
                           options_.base_frame, text_of(lookup.found)));
    return;
  }
  if (source == OdometrySource::kAuto) {
    if (!without_odometry_ && waiting <= kWaitForOdometry) {
      out.ready = false;
      return;
    }
    without_odometry_ = true;
    return;
  }
  out.ready = waiting >= kDepth;
  told_.note(Trouble::kOdometryMissing, now,
             fmt::format("{} -> {}: {}", options_.odom_frame, options_.base_frame, text_of(lookup.found)));
}

ScanIntake::Readiness ScanIntake::readiness_of(const Waiting& scan, Stamp now) {
  if (!other_lasers_are_past(scan)) return {};
  Readiness out = mounting_of(scan, now);
  if (out.ready) odometry_of(scan, out, now);
  return out;
}

RangeMeasurement ScanIntake::measure(Waiting&& waiting, const Readiness& at) const {
  Scan scan = std::move(waiting.scan);
  if (options_.range_max_m > 0.0) scan = reduce_scan(scan, options_.range_max_m, 1);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.is_hit(i) && scan.ranges[i] < options_.range_min_m) scan.miss(i, BeamState::kTooNear);
  }
  if (at.flipped) scan = mirrored_scan(scan);
  return {std::move(scan), waiting.frame, at.T_base_laser, at.T_odom_base};
}

std::vector<ReadyScan> ScanIntake::take_ready(Stamp now) {
  std::vector<ReadyScan> out;
  while (!queue_.empty()) {
    const Readiness at = readiness_of(queue_.front(), now);
    if (!at.ready && !at.drop) {
      const std::string topic = queue_.front().topic;
      if (waiting_of(topic) <= kDepth) break;
      push_out(topic, now);
      continue;
    }
    Waiting scan = std::move(queue_.front());
    queue_.pop_front();
    if (at.drop) continue;
    last_taken_ = scan.scan.stamp;
    ReadyScan ready;
    ready.topic = scan.topic;
    ready.new_session = std::exchange(session_begins_, false);
    ready.measurement = measure(std::move(scan), at);
    out.push_back(std::move(ready));
  }
  return out;
}

void ScanIntake::restart_at(Stamp stamp) {
  queue_.clear();
  newest_.clear();
  own_.clear();
  last_taken_.reset();
  session_begins_ = true;
  transforms_.forget_after(stamp + TransformBuffer::kJump);
  odometry_.forget_after(stamp + TransformBuffer::kJump);
}

}  // namespace phasescan::ros2
