#include "ros2/scan_gate.hpp"

#include <fmt/format.h>

#include "io/ros_tf.hpp"

namespace phasescan::ros2 {

bool ScanGate::is_usable(const std::string& topic, const LaserScan& message, Stamp now,
                         Diagnostics& diagnostics) const {
  if (message.ranges.empty()) {
    diagnostics.note(Trouble::kNoBeams, now, topic + ": a scan without a beam");
    return false;
  }
  if (message.header.frame_id.empty()) {
    diagnostics.note(Trouble::kBadScan, now, topic + ": header.frame_id is empty; expected the laser's frame");
    return false;
  }
  return true;
}

GatedScan ScanGate::take(const std::string& topic, const LaserScan& message, Stamp now, Diagnostics& diagnostics) {
  if (!is_usable(topic, message, now, diagnostics)) return {};
  Topic& known = topics_[topic];
  GatedScan out;
  out.frame = ros::plain_frame(message.header.frame_id);
  const Stamp stamp = message.header.stamp != 0 ? message.header.stamp : now;
  out.stamp = stamp;
  const double back_s = known.started ? stamp_to_seconds(known.last - stamp) : 0.0;
  if (known.started && out.frame != known.frame) {
    diagnostics.note(Trouble::kTwoPublishers, now,
                     fmt::format("{}: scans of frame {} and of frame {}; expected one laser on a topic", topic,
                                 known.frame, out.frame));
  }
  if (back_s > kJump_s) {
    diagnostics.note(Trouble::kClockJumpedBack, now, fmt::format("{}: stamps went back by {:.1f} s", topic, back_s));
    topics_.clear();
    out = take(topic, message, now, diagnostics);
    out.clock_jumped_back = true;
    return out;
  }
  if (back_s > 0.0) {
    diagnostics.note(
        Trouble::kOutOfOrder, now,
        fmt::format("{}: a scan {:.3f} s older than the one before; do two drivers publish?", topic, back_s));
    return {};
  }
  try {
    out.scan = known.reading.read(message);
  } catch (const DecodeError& error) {
    diagnostics.note(Trouble::kBadScan, now, topic + ": " + error.what());
    return {};
  }
  out.scan->stamp = stamp;
  if (known.started && known.beams != message.ranges.size()) {
    diagnostics.note(Trouble::kBeamsChanged, now,
                     fmt::format("{}: {} beams, {} before", topic, message.ranges.size(), known.beams));
  }
  if (out.scan->hit_count() == 0)
    diagnostics.note(Trouble::kNoReturns, now, topic + ": a scan without one range; is the laser covered?");
  known.last = stamp;
  known.frame = out.frame;
  known.beams = message.ranges.size();
  known.started = true;
  return out;
}

}  // namespace phasescan::ros2
