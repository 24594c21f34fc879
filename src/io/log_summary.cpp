#include "io/log_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace phasescan {

void LogSummary::add(const LogEntry& entry) {
  const Scan& scan = entry.scan;
  const std::size_t n = scan.size();
  ++lasers_[entry.laser];
  beams_min_ = scans_ == 0 ? n : std::min(beams_min_, n);
  beams_max_ = std::max(beams_max_, n);
  const double step = n > 1 ? scan.angle(1) - scan.angle(0) : 0.0;
  clockwise_ += step < 0.0;
  if (n > 1) field_of_view_max_ = std::max(field_of_view_max_, std::abs(scan.angle(n - 1) - scan.angle(0)));
  with_angles_ += !scan.angles.empty();
  flipped_ += entry.flipped;
  range_max_stated_ = std::max(range_max_stated_, scan.geometry.range_max);
  range_max_unknown_ += scan.geometry.range_max <= 0.0;
  with_intensities_ += !scan.intensities.empty();
  with_time_increment_ += scan.time_increment > 0.0;
  for (std::size_t state = 0; state < states_.size(); ++state) {
    states_[state] +=
        static_cast<std::size_t>(std::count(scan.states.begin(), scan.states.end(), static_cast<BeamState>(state)));
  }
  float longest = 0.0F;
  for (const float range : scan.ranges) longest = range > longest ? range : longest;  // a missing one is NaN
  longest_hit_ = std::max(longest_hit_, static_cast<double>(longest));
  usable_ += longest > 0.0F;
  add_stamp(scan.stamp);
  add_odometry(entry);
  ++scans_;
}

void LogSummary::add_stamp(Stamp stamp) {
  if (scans_ == 0) {
    first_ = last_ = stamp;
  } else {
    backwards_ += stamp < previous_;
    repeated_ += stamp == previous_;
  }
  first_ = std::min(first_, stamp);
  last_ = std::max(last_, stamp);
  previous_ = stamp;
}

void LogSummary::add_odometry(const LogEntry& entry) {
  if (!entry.odometry) return;
  ++with_odometry_;
  if (previous_odometry_) odometry_path_ += translation_distance(*previous_odometry_, *entry.odometry);
  previous_odometry_ = entry.odometry;
  if (!entry.corrected) return;
  ++with_both_;
  constexpr double kSame = 1e-6;
  const Pose2 T_odom_laser = *entry.odometry * entry.T_base_laser;
  same_in_both_ += translation_distance(T_odom_laser, *entry.corrected) < kSame &&
                   angle_distance(T_odom_laser.theta, entry.corrected->theta) < kSame;
}

std::vector<std::pair<std::string, std::string>> LogSummary::lines() const {
  std::vector<std::pair<std::string, std::string>> out;
  const auto add = [&](std::string name, std::string value) { out.emplace_back(std::move(name), std::move(value)); };
  add("scans", fmt::format("{}, {} of them with a hit", scans_, usable_));
  if (scans_ == 0) return out;
  for (const auto& [laser, count] : lasers_) add("laser " + laser, fmt::format("{} scans", count));
  add("beams", beams_min_ == beams_max_ ? fmt::format("{} a scan", beams_min_)
                                        : fmt::format("{} to {} a scan", beams_min_, beams_max_));
  add("first to last beam", fmt::format("{:.1f} deg{}", rad_to_deg(field_of_view_max_),
                                        with_angles_ > 0 ? ", directions given beam by beam" : ""));
  add("direction", clockwise_ == 0        ? "counter-clockwise"
                   : clockwise_ == scans_ ? "clockwise"
                                          : fmt::format("clockwise in {} scans", clockwise_));
  if (flipped_ > 0) add("mounting", "upside down");
  add("range_max", range_max_unknown_ == scans_ ? std::string("not stated: taken from the data")
                                                : fmt::format("{:g} m stated", range_max_stated_));
  add("longest hit", fmt::format("{:.2f} m", longest_hit_));
  std::size_t beams = 0;
  for (const std::size_t count : states_) beams += count;
  static constexpr std::array<const char*, 5> kReasons{"hits", "no return", "out of range", "too near", "invalid"};
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (states_[i] == 0) continue;
    add(fmt::format("beams, {}", kReasons[i]),
        fmt::format("{:.2f} %", 100.0 * static_cast<double>(states_[i]) / static_cast<double>(beams)));
  }
  if (with_intensities_ > 0) add("intensities", fmt::format("in {} scans", with_intensities_));
  add("time between beams",
      with_time_increment_ > 0 ? fmt::format("in {} scans", with_time_increment_) : std::string("not stated"));
  const double seconds = stamp_to_seconds(last_ - first_);
  add("duration",
      fmt::format("{:.2f} s{}", seconds,
                  seconds > 0.0 ? fmt::format(", {:.2f} scans/s", static_cast<double>(scans_ - 1) / seconds) : ""));
  if (backwards_ > 0) add("stamps, backwards", fmt::format("{} (the file's order is kept)", backwards_));
  if (repeated_ > 0) add("stamps, repeated", fmt::format("{}", repeated_));
  if (with_odometry_ == 0) {
    add("odometry", "none");
  } else if (odometry_equals_corrected()) {
    add("odometry", "equals the log's corrected pose in every scan");
  } else {
    add("odometry", fmt::format("with {} scans, path {:.2f} m", with_odometry_, odometry_path_));
  }
  if (with_both_ > 0) add("corrected pose", fmt::format("with {} scans (never used to match or map)", with_both_));
  return out;
}

}  // namespace phasescan
