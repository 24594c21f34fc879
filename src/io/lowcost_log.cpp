#include "io/lowcost_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/log_format.hpp"
#include "io/lowcost_text.hpp"
#include "io/text_log.hpp"
#include "io/text_numbers.hpp"

namespace phasescan {
namespace {

constexpr double kMillimetre = 1e-3;

/// Adds a step of wheel odometry: forward on the arc's chord, then turned.
Pose2 add_step(const Pose2& pose, double forward_m, double turn_rad) {
  return pose * Pose2{forward_m * std::cos(turn_rad / 2.0), forward_m * std::sin(turn_rad / 2.0), turn_rad};
}

class LowcostReader : public TextLogReader {
 public:
  using TextLogReader::TextLogReader;

  std::optional<LogEntry> next() final {
    std::string line;
    while (next_line(line)) {
      if (line.front() == '#') continue;
      split_fields(line, separator(), fields_);
      // The last line of a file that was cut off may still be made of numbers.
      if (!line_was_ended() && !whole_by_count(fields_.size())) {
        damage_here("truncated line", "the file ends inside the line");
        continue;
      }
      if (!parse_numbers(fields_, numbers_)) {
        damage_here("bad number", "field " + std::to_string(numbers_.size() + 1) + " is " +
                                      quote_text(fields_[numbers_.size()]) + "; expected a number");
        continue;
      }
      LogEntry entry;
      entry.line = line_number();
      if (read(numbers_, entry)) return entry;
    }
    return std::nullopt;
  }

  std::map<std::string, std::string> facts() const override {
    if (odometry_left_out_ == 0) return {};
    return {{"odometry steps left out", std::to_string(odometry_left_out_) + " that no robot makes between two scans"}};
  }

 protected:
  virtual char separator() const { return ' '; }
  /// Whether a last line without its end is whole by its count.
  virtual bool whole_by_count(std::size_t fields) const = 0;
  virtual bool read(const std::vector<double>& numbers, LogEntry& entry) = 0;

  bool wrong_count(std::size_t expected, std::size_t got) {
    if (got == expected) return false;
    damage_here("wrong count", std::to_string(got) + " numbers; expected " + std::to_string(expected));
    return true;
  }

  /// Ranges from `begin` on, times `unit`.
  Scan scan_of(std::span<const double> ranges, double unit, ScanGeometry geometry) {
    raw_.resize(ranges.size());
    std::transform(ranges.begin(), ranges.end(), raw_.begin(),
                   [unit](double r) { return static_cast<float>(r * unit); });
    return make_scan(raw_, geometry);
  }

  Pose2 T_odom_base_;
  std::size_t odometry_left_out_ = 0;

 private:
  std::vector<std::string_view> fields_;
  std::vector<double> numbers_;
  std::vector<float> raw_;
};

class SlambotReader final : public LowcostReader {
 public:
  using LowcostReader::LowcostReader;
  std::string format() const override { return "low-cost text (ticks, 360 ranges)"; }

 protected:
  bool whole_by_count(std::size_t fields) const override { return fields == kSlambotNumbers; }

  bool read(const std::vector<double>& n, LogEntry& entry) override {
    if (wrong_count(kSlambotNumbers, n.size())) return false;
    if (!is_integer_up_to(n[0], 65536) || !is_integer_up_to(n[1], 65536) || !is_integer_up_to(n[2], 65536)) {
      damage_here("bad number", "encoder or time is no integer of 16 bits");
      return false;
    }
    ScanGeometry geometry;
    geometry.angle_increment = -kPi / 180.0;
    entry.scan = scan_of(std::span(n).subspan(3), kMillimetre, geometry);
    entry.T_base_laser = {-0.035, 0.0, 0.0};
    bool believed = true;
    if (!first_) {
      const double left = wrapped_difference(n[0], last_[0]);
      const double right = wrapped_difference(n[1], last_[1]);
      stamp_ += Stamp{static_cast<std::uint16_t>(wrapped_difference(n[2], last_[2]))} * 1'000'000;
      const double forward = (left + right) / 2.0 * kMetresPerTick;
      const double turn = -(left - right) / 2.0 * kRadiansPerTick;
      believed = std::abs(turn) <= deg_to_rad(20.0) && std::abs(forward) <= 0.05;
      if (believed) T_odom_base_ = add_step(T_odom_base_, forward, turn);
    } else {
      stamp_ = static_cast<Stamp>(n[2]) * 1'000'000;
    }
    first_ = false;
    std::copy_n(n.begin(), 3, last_.begin());
    entry.scan.stamp = stamp_;
    // A step that was left out is unknown motion: this scan has no odometry, the next goes on from the last pose.
    if (believed) {
      entry.odometry = T_odom_base_;
    } else {
      ++odometry_left_out_;
    }
    return true;
  }

 private:
  static constexpr double kTicksPerTurn = 1000.0 / 3.0;
  static constexpr double kWheelDiameter = 0.0582;
  static constexpr double kTrack = 0.190;
  static constexpr double kMetresPerTick = kPi * kWheelDiameter / kTicksPerTurn;
  /// Tracks slip while turning: the divisor is the slip model of the robot's authors.
  static constexpr double kSlip = 0.9 * ((177.0 / 190.0) * (177.0 / 190.0) + 1.0);
  static constexpr double kRadiansPerTick = 2.0 * kPi * kWheelDiameter / kTrack / kTicksPerTurn / kSlip;

  bool first_ = true;
  std::array<double, 3> last_{};
  Stamp stamp_ = 0;
};

class BreezyReader final : public LowcostReader {
 public:
  using LowcostReader::LowcostReader;
  std::string format() const override { return "low-cost text (24 numbers, 682 ranges)"; }

 protected:
  bool whole_by_count(std::size_t fields) const override { return fields == kBreezyHead + kBreezyBeams + 1; }

  bool read(const std::vector<double>& n, LogEntry& entry) override {
    if (wrong_count(kBreezyHead + kBreezyBeams + 1, n.size())) return false;
    if (!is_integer_up_to(n[0], 1e6 * kMostStampSeconds) || !is_integer_up_to(n[2], 1e12) ||
        !is_integer_up_to(n[3], 1e12)) {
      damage_here("bad number", "time or encoder is no integer");
      return false;
    }
    ScanGeometry geometry;
    geometry.angle_min = deg_to_rad(-120.0);
    geometry.angle_increment = deg_to_rad(240.0) / static_cast<double>(kBreezyBeams - 1);
    geometry.range_min = 0.02;  // below it the URG's numbers are error codes
    geometry.range_max = 5.6;
    entry.scan = scan_of(std::span(n).subspan(kBreezyHead, kBreezyBeams), kMillimetre, geometry);
    entry.scan.stamp = static_cast<Stamp>(n[0]) * 1000;
    entry.T_base_laser = {0.145, 0.0, 0.0};
    if (!first_) {
      const double left = (n[2] - left_) * kRadiansPerTick;
      const double right = (n[3] - right_) * kRadiansPerTick;
      T_odom_base_ = add_step(T_odom_base_, kWheelRadius * (left + right), kWheelRadius / kHalfAxle * (right - left));
    }
    first_ = false;
    left_ = n[2];
    right_ = n[3];
    entry.odometry = T_odom_base_;
    return true;
  }

 private:
  static constexpr double kRadiansPerTick = kPi / 2000.0;
  static constexpr double kWheelRadius = 0.077;
  static constexpr double kHalfAxle = 0.165;

  bool first_ = true;
  double left_ = 0.0;
  double right_ = 0.0;
};

class PolarReader final : public LowcostReader {
 public:
  using LowcostReader::LowcostReader;
  std::string format() const override { return "low-cost text (distance, turn, seconds, ranges)"; }

 protected:
  char separator() const override { return ','; }
  bool whole_by_count(std::size_t) const override {
    return false;
  }  // any count is legal: nothing proves the line whole

  bool read(const std::vector<double>& n, LogEntry& entry) override {
    if (n.size() < kPolarHead + 1) {
      damage_here("wrong count", std::to_string(n.size()) + " numbers; expected distance, turn, seconds and ranges");
      return false;
    }
    if (!std::isfinite(n[0]) || !std::isfinite(n[1]) || !(n[2] >= 0.0 && n[2] < 1e6) ||
        stamp_to_seconds(stamp_) + n[2] > kMostStampSeconds) {
      damage_here("bad number", "distance, turn or seconds is out of bounds");
      return false;
    }
    ScanGeometry geometry;
    geometry.angle_increment = 2.0 * kPi / static_cast<double>(n.size() - kPolarHead);
    geometry.range_max = 10.0;
    entry.scan = scan_of(std::span(n).subspan(kPolarHead), 1.0, geometry);
    // The first line's motion is since the logger started, before any scan.
    if (!first_) {
      stamp_ += stamp_from_seconds(n[2]);
      T_odom_base_ = add_step(T_odom_base_, n[0] * kMillimetre, deg_to_rad(n[1]));
    }
    first_ = false;
    entry.scan.stamp = stamp_;
    entry.odometry = T_odom_base_;
    return true;
  }

 private:
  bool first_ = true;
  Stamp stamp_ = 0;
};

}  // namespace

std::unique_ptr<LogReader> open_lowcost(LogInput& input, LowcostFormat format) {
  switch (format) {
    case LowcostFormat::kSlambot:
      return std::make_unique<SlambotReader>(input);
    case LowcostFormat::kBreezy:
      return std::make_unique<BreezyReader>(input);
    case LowcostFormat::kPolar:
      break;
  }
  return std::make_unique<PolarReader>(input);
}

LogFormat lowcost_format() {
  return {
      "low-cost text", [](const LogInput& input) { return sniff_lowcost(input.prefix()).has_value(); },
      [](LogInput& input, const LogOptions&) { return open_lowcost(input, sniff_lowcost(input.prefix()).value()); }};
}

}  // namespace phasescan
