// What the MCAP writer writes: read back by our own reader to the last bit, and the golden bytes of each message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "io/ros_encode.hpp"
#include "phasescan/io/log.hpp"
#include "io/mcap_file.hpp"
#include "io/mcap_writer.hpp"
#include "support/ros_fixture.hpp"
#include "support/temp.hpp"

namespace phasescan::mcap_writer_test {
namespace {

ros::Odometry odometry_message(Stamp stamp, double x, double y) {
  ros::Odometry message;
  message.header.stamp = stamp;
  message.header.frame_id = "odom";
  message.child_frame_id = "base_link";
  message.pose = ros::spatial({x, y, 0.0});
  return message;
}

Scan some_scan(Stamp stamp) {
  const std::vector<float> raw = {1.5F,
                                  0.0F,
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::quiet_NaN(),
                                  5.999F};
  Scan scan = make_scan(raw, {-0.5F, 0.0009765625F, 0.1F, 6.0F});
  scan.stamp = stamp;
  scan.time_increment = 0.0009765625;
  scan.intensities = {1, 2, 3, 4, 5, 6};
  return scan;
}

TEST(McapWriter, WhatIsWrittenIsReadBackToTheLastBit) {
  const test::TempFolder folder;
  McapWriter writer(folder / "a.mcap");
  constexpr int kScans = 600;  // several chunks
  const Stamp start = 1'700'000'000'123'456'789;
  writer.static_transform(start, "base_link", "laser", {0.1, -0.2, 0.5}, true);
  for (int k = 0; k < kScans; ++k) {
    const Stamp stamp = start + k * Stamp{100'000'001};
    Scan scan = some_scan(stamp);
    scan.ranges[0] = 1.0F + 0.001F * static_cast<float>(k);
    for (int more = 0; more < 500; ++more) {
      scan.ranges.push_back(2.0F);
      scan.states.push_back(BeamState::kHit);
      scan.intensities.push_back(0.0F);
    }
    writer.odometry("/odom", stamp, "odom", "base_link", {0.1 * k, 1.0 / (k + 1), 0.005 * k});
    writer.scan("/scan", "laser", scan, 0.1);
  }
  writer.close();
  const auto log = open_log(folder / "a.mcap");
  for (int k = 0; k < kScans; ++k) {
    const auto entry = log->next();
    ASSERT_TRUE(entry);
    EXPECT_EQ(entry->scan.stamp, start + k * Stamp{100'000'001});
    const Scan expected = some_scan(0);
    EXPECT_EQ(entry->scan.geometry.angle_min, expected.geometry.angle_min);
    EXPECT_EQ(entry->scan.geometry.angle_increment, expected.geometry.angle_increment);
    EXPECT_EQ(entry->scan.geometry.range_max, expected.geometry.range_max);
    EXPECT_EQ(entry->scan.time_increment, expected.time_increment);
    ASSERT_EQ(entry->scan.size(), 506U);
    EXPECT_EQ(entry->scan.ranges[0], 1.0F + 0.001F * static_cast<float>(k));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(entry->scan.states[i], expected.states[i]);
    EXPECT_EQ(entry->scan.intensities[5], 6.0F);
    ASSERT_TRUE(entry->odometry);
    EXPECT_EQ(entry->odometry->x, 0.1 * k);
    EXPECT_EQ(entry->odometry->y, 1.0 / (k + 1));
    EXPECT_NEAR(entry->odometry->theta, 0.005 * k, 1e-12);
    EXPECT_TRUE(entry->flipped);
    EXPECT_NEAR(entry->T_base_laser.theta, 0.5, 1e-12);
    EXPECT_NEAR(entry->T_base_laser.y, -0.2, 1e-12);
  }
  EXPECT_FALSE(log->next());
  EXPECT_EQ(log->damage_count(), 0U);
}

TEST(McapWriter, TheSameMessagesAreTheSameBytes) {
  const test::TempFolder folder;
  for (const char* name : {"a", "b"}) {
    McapWriter writer(folder / name);
    const std::vector<std::int8_t> cells = {-1, 0, 100, 50, 0, 0};
    const std::vector<std::pair<Stamp, Pose2>> poses = {{1, {1, 2, 3}}, {2, {4, 5, -3}}};
    writer.grid("/map", 5, "map", {0.05, 3, 2, {-1, -2, 0}, cells});
    writer.path("/path", 6, "map", poses);
    writer.transform(7, "map", "odom", {});
    writer.close();
  }
  EXPECT_EQ(test::read_bytes(folder / "a"), test::read_bytes(folder / "b"));
}

/// A file that grows keeps what its index will say on the disk: the bytes are the same.
TEST(McapFile, AnIndexThatWaitsOnTheDiskIsTheSame) {
  const test::TempFolder folder;
  const std::vector<std::uint8_t> message(40, 7);
  const auto fill = [&](McapFile& file) {
    for (int i = 0; i < 1500; ++i) {
      file.add(i % 3 == 0 ? "/a" : "/b", "std_msgs/msg/String", 1000 * i, message);
      file.flush();
    }
    file.finish();
  };
  McapFile whole(folder / "whole.mcap");
  McapFile growing{GrowingFile(folder / "growing.mcap")};
  fill(whole);
  fill(growing);
  const auto bytes = test::read_bytes(folder / "whole.mcap");
  EXPECT_GT(bytes.size(), 300000U);
  EXPECT_EQ(bytes, test::read_bytes(folder / "growing.mcap"));
}

TEST(McapWriter, WithoutCloseThereIsNoFile) {
  const test::TempFolder folder;
  { McapWriter(folder / "a").transform(7, "map", "odom", {}); }
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
}

TEST(RosEncode, SizesAndOffsetsAreThoseOfTheWireFormat) {
  ByteWriter scan;
  ros::LaserScan message;
  message.header.frame_id = "laser";
  message.ranges = {1, 2, 3};
  encode(message, scan);
  EXPECT_EQ(scan.size(), 72U);
  ByteWriter odometry;
  encode(odometry_message(0, 7.0, 0.0), odometry);
  EXPECT_EQ(odometry.size(), 724U);
  double x = 0;
  std::memcpy(&x, odometry.bytes().data() + 44, 8);
  EXPECT_EQ(x, 7.0);
  ByteWriter transform;
  std::vector<ros::Transform> transforms(1);
  transforms[0].header.frame_id = "map";
  transforms[0].child_frame_id = "odom";
  encode(transforms, transform);
  EXPECT_EQ(transform.size(), 92U);
}

TEST(RosEncode, TheOtherHandEncodesTheSame) {
  ByteWriter ours;
  encode(odometry_message(1'500'000'000'000'000'007, 1.5, -2.5), ours);
  const std::string theirs = test::odometry(false, 1'500'000'000'000'000'007, 1.5, -2.5, 0.0);
  EXPECT_EQ(std::string(ours.bytes().begin(), ours.bytes().end()), theirs);
}

TEST(RosMessages, UnevenAnglesAreNoLaserScan) {
  const std::vector<float> ranges = {1, 1, 1};
  const std::vector<float> angles = {0.0F, 0.1F, 1.0F};
  EXPECT_THROW(ros::from_scan(make_scan(ranges, {}, angles), "laser", 0), std::invalid_argument);
  const std::vector<float> even = {0.0F, 0.1F, 0.2F};
  EXPECT_FLOAT_EQ(ros::from_scan(make_scan(ranges, {}, even), "laser", 0).angle_increment, 0.1F);
}

TEST(RosMessages, BigEndianAndTheSecondCdrAreRead) {
  std::string big("\0\0\0\0", 4);
  const auto put = [&big](auto value) {
    const auto* raw = reinterpret_cast<const char*>(&value);
    for (std::size_t i = sizeof value; i-- > 0;) big += raw[i];
  };
  put(std::int32_t{3});
  put(std::uint32_t{4});
  put(std::uint32_t{2});
  big += std::string("l\0\0\0", 4);
  for (const float value : {-1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 9.0F}) put(value);
  put(std::uint32_t{3});
  for (const float value : {1.0F, 2.0F, 3.0F}) put(value);
  put(std::uint32_t{0});
  ros::LaserScan message;
  decode(ros::Wire::kCdr, Bytes(reinterpret_cast<const std::uint8_t*>(big.data()), big.size()), message);
  EXPECT_EQ(message.header.stamp, 3'000'000'004);
  EXPECT_EQ(message.header.frame_id, "l");
  EXPECT_EQ(message.angle_min, -1.0F);
  EXPECT_THAT(message.ranges, testing::ElementsAre(1.0F, 2.0F, 3.0F));
}

}  // namespace
}  // namespace phasescan::mcap_writer_test
