/// The same messages for every container, and what they must be read as.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/io/log.hpp"
#include "support/ros_fixture.hpp"

namespace phasescan::test {

inline constexpr std::int64_t kStart = 1'600'000'000'000'000'000;
inline constexpr std::int64_t kMs = 1'000'000;

inline std::vector<float> ranges_of(int k) {
  std::vector<float> out(91);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = 1.0F + 0.01F * static_cast<float>((static_cast<std::size_t>(k) * 7 + i * 3) % 200);
  out[3] = 0.0F;
  out[4] = std::numeric_limits<float>::infinity();
  out[5] = std::numeric_limits<float>::quiet_NaN();
  out[6] = 0.01F;
  return out;
}

/// Scans every 100 ms between odometry samples every 50 ms at x = t, and a static transform.
inline std::vector<Message> messages(bool ros1, int scans = 11) {
  const std::string slash = ros1 ? "/" : "/msg/";
  std::vector<Message> out;
  out.push_back({"/tf_static", "tf2_msgs" + slash + "TFMessage", kStart,
                 transforms(ros1, {{kStart, "base_link", "plate", 0.1, 0.0, {}},
                                   {kStart, "plate", "laser", 0.1, 0.05, {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}})});
  out.push_back({"/chatter", "std_msgs" + slash + "String", kStart, "\1\2\3"});
  for (int k = 0; k < scans; ++k) {
    const std::int64_t t = kStart + k * 100 * kMs;
    out.push_back(
        {"/odom", "nav_msgs" + slash + "Odometry", t, odometry(ros1, t - 25 * kMs, 0.1 * k - 0.025, 2.0, 0.1 * k)});
    out.push_back({"/scan", "sensor_msgs" + slash + "LaserScan", t, laser_scan(ros1, t, ranges_of(k))});
    out.push_back({"/odom", "nav_msgs" + slash + "Odometry", t + 30 * kMs,
                   odometry(ros1, t + 25 * kMs, 0.1 * k + 0.025, 2.0, 0.1 * k)});
  }
  return out;
}

struct Read {
  std::vector<LogEntry> entries;
  std::vector<LogDamage> damages;
  std::string format;
  std::map<std::string, std::string> facts;
};

inline Read read_all(const std::string& path, const LogOptions& options = {}) {
  const auto log = open_log(path, options);
  Read out;
  while (auto entry = log->next()) out.entries.push_back(std::move(*entry));
  out.damages = log->damages();
  out.format = log->format();
  out.facts = log->facts();
  return out;
}

inline void expect_whole(const Read& read, int scans = 11) {
  EXPECT_TRUE(read.damages.empty()) << read.damages.front().text;
  ASSERT_EQ(read.entries.size(), static_cast<std::size_t>(scans));
  for (int k = 0; k < scans; ++k) {
    const LogEntry& entry = read.entries[static_cast<std::size_t>(k)];
    EXPECT_EQ(entry.scan.stamp, kStart + k * 100 * kMs);
    EXPECT_EQ(entry.laser, "/scan");
    const std::vector<float> expected = ranges_of(k);
    ASSERT_EQ(entry.scan.size(), expected.size());
    for (std::size_t i = 7; i < expected.size(); ++i) ASSERT_EQ(entry.scan.ranges[i], expected[i]);
    EXPECT_EQ(entry.scan.states[3], BeamState::kNoReturn);
    EXPECT_EQ(entry.scan.states[4], BeamState::kOutOfRange);
    EXPECT_EQ(entry.scan.states[5], BeamState::kInvalid);
    EXPECT_EQ(entry.scan.states[6], BeamState::kTooNear);
    ASSERT_TRUE(entry.odometry);
    EXPECT_NEAR(entry.odometry->x, 0.1 * k, 1e-12);
    EXPECT_NEAR(entry.odometry->y, 2.0, 1e-12);
    EXPECT_NEAR(entry.odometry->theta, 0.1 * k, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.x, 0.2, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.y, 0.05, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.theta, M_PI / 2, 1e-9);
    EXPECT_FALSE(entry.flipped);
  }
}

}  // namespace phasescan::test
