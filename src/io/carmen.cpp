// CARMEN logs: FLASER, RAWLASERk, ROBOTLASERk (both dialects), ODOM, PARAM; everything else is passed over.
//
//   FLASER n r.. x y theta ox oy otheta t host lt
//   RAWLASERk type start fov res maxr acc rem n r.. m rem.. t host lt
//   ROBOTLASERk type start fov res maxr acc rem n r.. [m rem..] lx ly ltheta rx ry rtheta tv rv fwd side [turn] t host
//   lt
#include <algorithm>
#include <array>
#include <cmath>

#include "io/carmen_words.hpp"
#include "io/log_format.hpp"
#include "io/text_log.hpp"
#include "io/number.hpp"
#include "io/odometry_samples.hpp"
#include "phasescan/io/scan_json.hpp"

namespace phasescan {
namespace {

constexpr float kNoReturnFrom = 80.0F;  // [m] SICK scanners say 81.83 and the like for "nothing seen"
constexpr float kSickMaxRange = 82.0F;

std::vector<float> read_ranges(Words& words, std::size_t beams, float no_return_from) {
  std::vector<float> raw(beams);
  for (float& range : raw) {
    range = static_cast<float>(words.number("a range"));
    if (range >= no_return_from) range = 0.0F;
  }
  return raw;
}

bool is_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// `t host lt`: the first time counts. Old logs have whole seconds first and microseconds last. `ended`: the line has
// its newline, so that no digit of its last word is missing.
Stamp read_stamp(Words& words, bool ended) {
  const std::string_view first = words.word();
  words.word();
  const std::string_view last = words.word();
  auto stamp = parse_stamp(first);
  if (!stamp) throw BadLine{"bad value", "the time is " + quote_text(first) + "; expected seconds"};
  if (is_digits(first) && is_digits(last) && first.size() >= 9 && last.size() <= 6) {
    if (!ended) throw BadLine{"truncated line", "the file ends inside the time"};
    *stamp += *parse_number<Stamp>(last) * 1000;
  }
  return *stamp;
}

// `type start fov res maxr acc rem n` of RAWLASER and ROBOTLASER.
struct LaserHeader {
  ScanGeometry geometry;
  float no_return_from = kNoReturnFrom;
  std::size_t beams = 0;

  explicit LaserHeader(Words& words) {
    words.word();
    geometry.angle_min = words.finite("the start angle", 100.0);
    const double field_of_view = words.finite("the field of view", 100.0);
    geometry.angle_increment = words.finite("the angular resolution", 100.0);
    const double max_range = words.number("the maximum range");
    words.word();
    words.word();
    beams = words.count("the number of ranges");
    if (geometry.angle_increment == 0.0 && beams > 1)
      geometry.angle_increment = field_of_view / static_cast<double>(beams - 1);
    if (geometry.angle_increment == 0.0 && beams > 1) {
      throw BadLine{"bad value", "angular resolution and field of view are 0; expected radians"};
    }
    if (max_range > 0.0 && std::isfinite(max_range)) {
      const auto stated = static_cast<float>(max_range);
      no_return_from = stated >= kNoReturnFrom && stated < kSickMaxRange ? kNoReturnFrom : stated;
      geometry.range_max = max_range;
    }
  }
};

class CarmenReader : public TextLogReader {
 public:
  using TextLogReader::TextLogReader;

  std::optional<LogEntry> next() override {
    for (bool ended = false;;) {
      if (auto entry = queue_.take(ended)) return entry;
      if (ended) return std::nullopt;
      ended = !next_line(text_);
      if (ended) continue;
      try {
        if (auto entry = read_line()) queue_.add(std::move(*entry));
      } catch (const BadLine& bad) {
        damage_here(bad.kind, bad.reason);
      }
    }
  }

  std::string format() const override { return "carmen"; }

  std::vector<LogRemark> remarks() const override {
    std::vector<LogRemark> out;
    queue_.add_remarks(out);
    return out;
  }

  std::map<std::string, std::string> facts() const override {
    std::map<std::string, std::string> out;
    for (const auto& [keyword, count] : counts_) out["lines " + keyword] = std::to_string(count);
    if (laser_ahead_) append_number(out["robot_frontlaser_offset"], *laser_ahead_);
    return out;
  }

 private:
  std::optional<LogEntry> read_line() {
    const std::size_t start = text_.find_first_not_of(" \t");
    if (text_[start] == '#') return std::nullopt;
    const std::string keyword = text_.substr(start, text_.find_first_of(" \t", start) - start);
    const bool robot = is_laser(keyword, "ROBOTLASER"), raw = is_laser(keyword, "RAWLASER");
    const bool known = robot || raw || keyword == "FLASER" || keyword == "ODOM" || keyword == "PARAM";
    // Words of a broken line must not fill the memory: what is unknown is counted by name only while there are few.
    if (known || counts_.size() < 32) ++counts_[known ? keyword : quote_text(keyword)];
    if (!known) {
      if (!line_was_ended()) throw BadLine{"truncated line", "the file ends inside the line"};
      return std::nullopt;
    }
    Words words(text_);
    words.word();
    if (keyword == "PARAM") return read_param(words);
    if (keyword == "ODOM") return read_odometry(words);
    LogEntry entry = robot ? read_robot_laser(words) : raw ? read_raw_laser(words) : read_front_laser(words);
    entry.laser = keyword;
    entry.line = line_number();
    return entry;
  }

  static bool is_laser(std::string_view keyword, std::string_view stem) {
    return keyword.starts_with(stem) && is_digits(keyword.substr(stem.size()));
  }

  std::optional<LogEntry> read_param(Words& words) {
    if (!line_was_ended()) throw BadLine{"truncated line", "the file ends inside the line"};
    const std::string_view name = words.word();
    if (words.left() == 0) return std::nullopt;
    const auto value = parse_number<double>(words.word());
    if (!value || !std::isfinite(*value)) return std::nullopt;
    if (name == "robot_frontlaser_offset" && std::abs(*value) < 100.0) laser_ahead_ = *value;
    if (name.ends_with("front_laser_fov") && *value > 0.0 && *value <= 360.0) {
      field_of_view_ = *value > kTwoPi ? deg_to_rad(*value) : *value;
    }
    return std::nullopt;
  }

  std::optional<LogEntry> read_odometry(Words& words) {
    constexpr std::size_t kRest = 6;  // tv rv accel t host lt
    const Pose2 pose = words.pose("the odometry");
    if (!line_was_ended() && words.left() < kRest) throw BadLine{"truncated line", "the file ends inside the line"};
    std::optional<Stamp> stamp;
    if (words.left() >= kRest) {
      for (int i = 0; i < 3; ++i) words.word();  // velocities and acceleration
      stamp = read_stamp(words, line_was_ended());
    }
    if (stamp && *stamp != 0) {
      queue_.add_sample({*stamp, pose});
      untimed_.reset();
    } else {
      untimed_ = pose;
    }
    return std::nullopt;
  }

  Pose2 laser_on_robot() const { return {laser_ahead_.value_or(0.0), 0.0, 0.0}; }

  LogEntry read_front_laser(Words& words) const {
    const std::size_t beams = words.count("the number of ranges");
    words.expect_left(beams + 9, beams);
    const std::vector<float> raw = read_ranges(words, beams, kNoReturnFrom);
    // 181 and 361 beams include both ends of the field, 180 and 360 lack the last.
    const std::size_t steps = std::max<std::size_t>(beams - beams % 2, 1);
    ScanGeometry geometry;
    geometry.angle_min = -field_of_view_ / 2.0;
    geometry.angle_increment = field_of_view_ / static_cast<double>(steps);
    LogEntry entry;
    entry.scan = make_scan(raw, geometry);
    entry.corrected = words.pose("the laser pose");
    entry.T_base_laser = laser_on_robot();
    const Pose2 T_odom_laser = words.pose("the odometry");
    entry.odometry = laser_ahead_ ? T_odom_laser * entry.T_base_laser.inverse() : T_odom_laser;
    entry.scan.stamp = read_stamp(words, line_was_ended());
    return entry;
  }

  LogEntry read_raw_laser(Words& words) const {
    const LaserHeader header(words);
    if (words.left() < header.beams + 1) words.expect_left(header.beams + 4, header.beams);
    LogEntry entry;
    entry.scan = make_scan(read_ranges(words, header.beams, header.no_return_from), header.geometry);
    const std::size_t remissions = words.count("the number of remissions");
    words.expect_left(remissions + 3, remissions);
    read_remissions(words, remissions, entry.scan);
    entry.T_base_laser = laser_on_robot();
    entry.odometry = untimed_;
    entry.scan.stamp = read_stamp(words, line_was_ended());
    return entry;
  }

  LogEntry read_robot_laser(Words& words) {
    const LaserHeader header(words);
    constexpr std::size_t kShort = 13, kLong = 14;  // from the laser pose on, without and with `turn`
    if (words.left() < header.beams + kShort) words.expect_left(header.beams + kShort, header.beams);
    LogEntry entry;
    entry.scan = make_scan(read_ranges(words, header.beams, header.no_return_from), header.geometry);
    const bool newer = words.left() != kShort;
    // A line of the newer dialect that was cut off can have the count of the older one, but no host in its place.
    if (!line_was_ended() && !newer && parse_number<double>(words.peek(kShort - 2)))
      throw BadLine{"truncated line", "the file ends inside the line"};
    if (newer) {
      const std::size_t remissions = words.count("the number of remissions");
      words.expect_left(remissions + kLong, remissions);
      read_remissions(words, remissions, entry.scan);
    }
    const Pose2 T_odom_laser = words.pose("the laser pose");
    entry.odometry = words.pose("the robot pose");
    entry.T_base_laser = entry.odometry->inverse() * T_odom_laser;
    for (int i = newer ? 5 : 4; i > 0; --i) words.number("a velocity or safety distance");
    entry.scan.stamp = read_stamp(words, line_was_ended());
    return entry;
  }

  static void read_remissions(Words& words, std::size_t count, Scan& scan) {
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(words.finite("a remission", 1e30));
    if (count == scan.size()) scan.intensities = std::move(values);
  }

  std::string text_;
  std::map<std::string, std::size_t> counts_;
  std::optional<double> laser_ahead_;
  double field_of_view_ = kPi;
  OdometryQueue queue_{OdometryQueue::Outside::kNearest};  ///< with the ODOM lines
  std::optional<Pose2> untimed_;                           ///< of the last ODOM line, where it says no time
};

bool is_carmen(const LogInput& input) {
  const std::string_view prefix = input.prefix();
  static constexpr std::array<std::string_view, 9> kStarts{"FLASER ",  "RAWLASER",         "ROBOTLASER",
                                                           "ODOM ",    "PARAM ",           "SYNC ",
                                                           "TRUEPOS ", "# CARMEN Logfile", "# message_name"};
  for (std::size_t from = 0; from < prefix.size();) {
    const std::string_view line = prefix.substr(from);
    if (std::any_of(kStarts.begin(), kStarts.end(), [&](std::string_view start) { return line.starts_with(start); }))
      return true;
    const std::size_t end = prefix.find('\n', from);
    if (end == std::string_view::npos) break;
    from = end + 1;
  }
  return false;
}

std::unique_ptr<LogReader> open_carmen(LogInput& input, const LogOptions&) {
  return std::make_unique<CarmenReader>(input);
}

}  // namespace

LogFormat carmen_format() {
  return {"CARMEN log", is_carmen, open_carmen};
}

}  // namespace phasescan
