// What all ROS containers share: topics, odometry at the stamp of a scan, where the laser sits, nonsense in messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/io/error.hpp"
#include "support/recordings.hpp"
#include "support/temp.hpp"

namespace phasescan::ros_log_test {
namespace {

using namespace test;

TEST(RosLog, ATopicIsChosenOrNamedAsMissing) {
  const TempFolder dir;
  auto all = messages(false, 3);
  all.push_back({"/rear", "sensor_msgs/msg/LaserScan", kStart, laser_scan(false, kStart, ranges_of(9))});
  write_bytes(dir / "a", mcap(all));
  EXPECT_EQ(read_all(dir / "a").entries.size(), 4U);
  const Read rear = read_all(dir / "a", {.topic = "/rear", .columns = ""});
  ASSERT_EQ(rear.entries.size(), 1U);
  EXPECT_EQ(rear.entries[0].laser, "/rear");
  try {
    read_all(dir / "a", {.topic = "/front", .columns = ""});
    FAIL() << "a topic that is not there was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/rear, /scan"));
  }
}

TEST(RosLog, ALaserUpsideDownIsFlippedAndOdometryComesFromTheTransform) {
  const TempFolder dir;
  std::vector<Message> all;
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
                 transforms(false, {{kStart, "base_footprint", "laser", 0.3, 0.1, {1, 0, 0, 0}}})});
  for (int k = 0; k < 5; ++k) {
    const std::int64_t t = kStart + k * 100 * kMs;
    all.push_back({"/tf", "tf2_msgs/msg/TFMessage", t,
                   transforms(false, {{t, "odom", "base_footprint", 0.5 * k, 0, {}}, {t, "map", "odom", 100, 0, {}}})});
    all.push_back({"/scan", "sensor_msgs/msg/LaserScan", t, laser_scan(false, t, ranges_of(k))});
  }
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_TRUE(read.entries[k].flipped);
    EXPECT_NEAR(read.entries[k].T_base_laser.x, 0.3, 1e-12);
    EXPECT_NEAR(read.entries[k].T_base_laser.theta, 0.0, 1e-12);
    ASSERT_TRUE(read.entries[k].odometry);
    EXPECT_NEAR(read.entries[k].odometry->x, 0.5 * static_cast<double>(k), 1e-12);
  }
}

TEST(RosLog, ScansFarFromAnyOdometryHaveNone) {
  const TempFolder dir;
  std::vector<Message> all;
  for (int k = 0; k < 20; ++k) {
    const std::int64_t t = kStart + k * 500 * kMs;
    if (k < 3) all.push_back({"/odom", "nav_msgs/msg/Odometry", t, odometry(false, t, 1.0 * k, 0, 0)});
    all.push_back({"/scan", "sensor_msgs/msg/LaserScan", t, laser_scan(false, t, ranges_of(k))});
  }
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 20U);
  EXPECT_TRUE(read.entries[2].odometry);
  EXPECT_FALSE(read.entries[3].odometry);
  EXPECT_FALSE(read.entries[19].odometry);
}

TEST(RosLog, NonsenseInAScanIsReadAsUnknown) {
  const TempFolder dir;
  std::vector<Message> all;
  all.push_back(
      {"/scan", "sensor_msgs/msg/LaserScan", kStart, laser_scan(false, kStart, ranges_of(1), "laser", 0.0F, 5.0F)});
  all.push_back({"/scan", "sensor_msgs/msg/LaserScan", kStart, "no scan at all"});
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 1U);
  EXPECT_EQ(read.entries[0].scan.geometry.range_max, 0.0);
  EXPECT_EQ(read.entries[0].scan.time_increment, 0.0);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_EQ(read.damages[0].kind, "bad message");
  EXPECT_THAT(read.damages[0].text, testing::HasSubstr("message 2 of /scan"));
}

}  // namespace
}  // namespace phasescan::ros_log_test
