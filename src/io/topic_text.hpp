// What readers of a topic printed as text share: one LaserScan after the other, of one frame where one was asked for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/ros_messages.hpp"
#include "io/ros_scan.hpp"
#include "io/ros_tf.hpp"
#include "io/text_log.hpp"

namespace phasescan {

class TopicTextReader : public TextLogReader {
 public:
  TopicTextReader(LogInput& input, const LogOptions& options)
      : TextLogReader(input), frame_(ros::plain_frame(options.frame)) {}

  std::vector<LogRemark> remarks() const override {
    std::vector<LogRemark> out;
    reading_.add_remarks("the topic", out);
    return out;
  }

 protected:
  /// Whether the message's frame is the one that was asked for, or none was.
  bool is_wanted() const { return frame_.empty() || ros::plain_frame(message_.header.frame_id) == frame_; }

  /// @throws DecodeError where the beams have no direction.
  LogEntry entry_of_message(long line) {
    LogEntry entry;
    entry.scan = reading_.read(message_);
    entry.laser = "scan";
    entry.line = line;
    return entry;
  }

  ros::LaserScan message_;

 private:
  std::string frame_;
  ros::ScanReading reading_;
};

/// The numbers of a LaserScan between its header and its ranges, in the order of the message.
inline std::array<float*, 7> scan_numbers(ros::LaserScan& message) {
  return {&message.angle_min, &message.angle_max, &message.angle_increment, &message.time_increment,
          &message.scan_time, &message.range_min, &message.range_max};
}

}  // namespace phasescan
