// What a recording says of itself at its end: facts, remarks, and topics or frames that were asked for and are not
// there.
#include <fmt/format.h>

#include "io/file.hpp"
#include "io/ros_log.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::ros {

void RosLogReader::check_topic() const {
  if (topic_.empty()) return;
  std::string others;
  for (const auto& [key, channel] : channels_) {
    if (!gives_scans(channel)) continue;
    if (channel.topic == topic_) return;
    others += (others.empty() ? "" : ", ") + channel.topic;
  }
  throw InputError(path_, 0,
                   "no scans on topic " + topic_ + "; " +
                       (others.empty() ? "the log has no LaserScan topic" : "expected one of " + others));
}

void RosLogReader::check_frame() const {
  if (frame_.empty()) return;
  std::string others;
  for (const auto& [key, channel] : channels_) {
    if (channel.frames.contains(frame_)) return;
    for (const auto& [frame, count] : channel.frames) others += (others.empty() ? "" : ", ") + quote_text(frame);
  }
  throw InputError(path_, 0,
                   "no scans in the frame " + quote_text(frame_) + "; " +
                       (others.empty() ? "the log holds no scan" : "expected one of " + others));
}

std::vector<LogRemark> RosLogReader::remarks() const {
  std::vector<LogRemark> out;
  bool any_scan = false;
  std::string others;
  for (const auto& [key, channel] : channels_) {
    if (!gives_scans(channel)) {
      if (others.size() < 300) others += (others.empty() ? "" : ", ") + channel.topic + " (" + channel.type + ")";
      continue;
    }
    any_scan = any_scan || !channel.frames.empty();
    channel.reading.add_remarks(channel.topic, out);
    if (channel.frames.size() > 1 && frame_.empty()) {
      std::string frames;
      for (const auto& [frame, count] : channel.frames)
        frames += (frames.empty() ? "" : ", ") + fmt::format("{} ({} scans)", frame, count);
      out.push_back({"several frames",
                     channel.topic + " has scans of several frames: " + frames + "; --frame picks one of them"});
    }
    if (channel.stamps == Channel::Stamps::kZero)
      out.push_back({"stamps all zero", channel.topic + ": the stamps are 0: the recorder's times are used"});
  }
  for (const auto& [frame, count] : tilted_) {
    out.push_back({"tilted laser",
                   fmt::format("the laser in the frame {} is tilted out of the plane by {:.0f} deg: its {} scans are "
                               "left out; --frame {} reads them",
                               frame, rad_to_deg(mountings_.at(frame)->tilt_rad), count, frame)});
  }
  clock_.add_remarks(out);
  if (!any_scan && !others.empty()) out.push_back({"no scans", "no topic holds scans that can be read: " + others});
  return out;
}

std::map<std::string, std::string> RosLogReader::facts() const {
  std::map<std::string, std::string> out;
  container_->add_facts(out);
  for (const auto& [key, channel] : channels_) {
    out["topic " + channel.topic] = channel.type + ", " + std::to_string(channel.messages) + " messages";
  }
  std::size_t absurd = 0;
  for (const auto& [key, channel] : channels_) absurd += channel.reading.absurd_time_increments();
  if (absurd > 0)
    out["time_increment absurd"] = std::to_string(absurd) + " scans state a turn of more than 2 s or less than none";
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
