// Recordings whose messages contradict themselves or each other, and scan types other than LaserScan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "io/ros_scan.hpp"
#include "phasescan/core/pose2.hpp"
#include "support/command.hpp"
#include "support/read_text.hpp"
#include "support/recordings.hpp"

namespace phasescan::odd_recordings_test {
namespace {

using test::kMs;
using test::kStart;
using test::Message;
using test::ReadText;
using ::testing::HasSubstr;

ros::LaserScan fan(double from, double to, double step, std::size_t beams, float range = 2.0F) {
  ros::LaserScan message;
  message.angle_min = static_cast<float>(from);
  message.angle_max = static_cast<float>(to);
  message.angle_increment = static_cast<float>(step);
  message.range_max = 10.0F;
  message.ranges.assign(beams, range);
  return message;
}

std::vector<std::string> kinds_of(const ros::ScanReading& reading) {
  std::vector<LogRemark> remarks;
  reading.add_remarks("/scan", remarks);
  std::vector<std::string> kinds;
  for (const LogRemark& remark : remarks) kinds.push_back(remark.kind);
  return kinds;
}

TEST(ScanReading, DegreesAreReadAsDegrees) {
  ros::ScanReading reading;
  const Scan scan = reading.read(fan(-119.5, 119.5, 0.351470588, 681));
  EXPECT_NEAR(scan.angle(0), deg_to_rad(-119.5), 1e-6);
  EXPECT_NEAR(scan.angle(680), deg_to_rad(119.5), 1e-4);
  EXPECT_THAT(kinds_of(reading), testing::ElementsAre("angles in degrees"));
}

TEST(ScanReading, AnIncrementThatLeadsBeyondATurnGivesWayToTheEnds) {
  ros::ScanReading reading;
  const Scan scan = reading.read(fan(-2.0, 2.0, 0.0349, 401));
  EXPECT_NEAR(scan.angle(400), 2.0, 1e-6);
  EXPECT_THAT(kinds_of(reading), testing::ElementsAre("increment contradicts angle_max"));
}

TEST(ScanReading, EndsThatDoNotFitAreSaidAndTheIncrementCounts) {
  for (const auto& [to, step] : {std::pair{2.0, -0.01}, std::pair{3.0, 0.01}, std::pair{1.0, 0.01}}) {
    ros::ScanReading reading;
    EXPECT_NEAR(reading.read(fan(-2.0, to, step, 401)).angle(400), -2.0 + 400 * step, 1e-5);
    EXPECT_THAT(kinds_of(reading), testing::ElementsAre("increment contradicts angle_max")) << to;
  }
}

TEST(ScanReading, WhatDriversDoEveryDayIsNoContradiction) {
  for (const ros::LaserScan& message :
       {fan(-kPi, kPi, kTwoPi / 359, 360), fan(0.0, kTwoPi, kTwoPi / 360, 360), fan(0.0, kTwoPi, kTwoPi / 454, 456),
        fan(kPi, -kPi, -kTwoPi / 359, 360), fan(0.0, 0.0, 0.0175, 360), fan(-2.0, 2.0, 0.01, 400)}) {
    ros::ScanReading reading;
    const Scan scan = reading.read(message);
    EXPECT_EQ(scan.geometry.angle_increment, double{message.angle_increment});
    EXPECT_TRUE(kinds_of(reading).empty()) << message.angle_increment;
  }
}

TEST(ScanReading, MillimetresAreReadAsMillimetres) {
  ros::ScanReading reading;
  ros::LaserScan message = fan(-1.0, 1.0, 0.02, 101, 2500.0F);
  message.range_min = 50.0F;
  message.range_max = 12000.0F;
  const Scan scan = reading.read(message);
  EXPECT_FLOAT_EQ(scan.ranges[3], 2.5F);
  EXPECT_DOUBLE_EQ(scan.geometry.range_max, 12.0);
  EXPECT_THAT(kinds_of(reading), testing::ElementsAre("ranges in millimetres"));
  message.ranges.assign(101, 60.0F);
  EXPECT_FLOAT_EQ(reading.read(message).ranges[0], 0.06F) << "decided once: a wall near by does not change the unit";
  ros::ScanReading outdoors;
  EXPECT_EQ(outdoors.read(fan(-1.0, 1.0, 0.02, 101, 5.0F)).ranges[0], 5.0F);
  message = fan(-1.0, 1.0, 0.02, 101, 150.0F);
  message.range_max = 200.0F;
  EXPECT_EQ(outdoors.read(message).ranges[0], 150.0F);
}

TEST(ScanReading, IntensitiesThatAreNotFiniteAreMissing) {
  ros::LaserScan message = fan(-1.0, 1.0, 1.0, 3);
  message.intensities = {1.0F, std::nanf(""), std::numeric_limits<float>::infinity()};
  ros::ScanReading reading;
  EXPECT_EQ(reading.read(message).intensities, (std::vector<float>{1.0F, 0.0F, 0.0F}));
}

std::vector<Message> scans_in_frames(const std::vector<std::string>& frames, std::int64_t step = 100 * kMs) {
  std::vector<Message> out;
  for (int k = 0; k < 12; ++k) {
    const std::int64_t t = kStart + k * 100 * kMs;
    out.push_back({"/scan", "sensor_msgs/msg/LaserScan", t,
                   test::laser_scan(false, step == 0 ? 0 : t, test::ranges_of(k),
                                    frames[static_cast<std::size_t>(k) % frames.size()])});
  }
  return out;
}

ReadText read_messages(const std::vector<Message>& messages, const LogOptions& options = {}) {
  const test::TempFolder folder;
  return test::read_log(folder.put("a.mcap", test::mcap(messages)), options);
}

TEST(OddRecordings, TwoPublishersOnOneTopicAreSaidAndOneIsPicked) {
  const ReadText read = read_messages(scans_in_frames({"base_laser", "laser_frame", "base_laser"}));
  EXPECT_EQ(read.entries.size(), 12U);
  ASSERT_TRUE(read.has_remark("several frames"));
  EXPECT_THAT(read.remarks.at(0).text, HasSubstr("base_laser (8 scans), laser_frame (4 scans)"));
  LogOptions options;
  options.frame = "/laser_frame";
  const ReadText one = read_messages(scans_in_frames({"base_laser", "laser_frame", "base_laser"}), options);
  EXPECT_EQ(one.entries.size(), 4U);
  EXPECT_FALSE(one.has_remark("several frames"));
  options.frame = "none";
  EXPECT_THROW(read_messages(scans_in_frames({"a", "b"}), options), InputError);
}

TEST(OddRecordings, ScansOfATiltedLaserAreLeftOutUnlessAskedFor) {
  std::vector<Message> messages = scans_in_frames({"level", "tilted"});
  const double half = 0.2;  // [rad], half of the angle about y
  messages.insert(
      messages.begin(),
      {"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
       test::transforms(false, {{kStart, "base_link", "level", 0.1, 0.0, {}},
                                {kStart, "base_link", "tilted", 0.1, 0.0, {0, std::sin(half), 0, std::cos(half)}}})});
  const ReadText read = read_messages(messages);
  EXPECT_EQ(read.entries.size(), 6U);
  ASSERT_TRUE(read.has_remark("tilted laser"));
  EXPECT_THAT(read.remarks.back().text, HasSubstr("tilted out of the plane by 23 deg: its 6 scans are left out"));
  LogOptions options;
  options.frame = "tilted";
  EXPECT_EQ(read_messages(messages, options).entries.size(), 6U);
}

TEST(OddRecordings, WithoutStampsTheRecordersTimesCount) {
  const ReadText read = read_messages(scans_in_frames({"laser"}, 0));
  ASSERT_EQ(read.entries.size(), 12U);
  for (int k = 0; k < 12; ++k) EXPECT_EQ(read.entries[static_cast<std::size_t>(k)].scan.stamp, kStart + k * 100 * kMs);
  EXPECT_TRUE(read.has_remark("stamps all zero"));
}

TEST(OddRecordings, ASimulationMayBeginAtZero) {
  std::vector<Message> messages;
  for (int k = 0; k < 5; ++k)
    messages.push_back(
        {"/scan", "sensor_msgs/msg/LaserScan", kStart + k, test::laser_scan(false, k * 100 * kMs, test::ranges_of(k))});
  const ReadText read = read_messages(messages);
  ASSERT_EQ(read.entries.size(), 5U);
  EXPECT_EQ(read.entries[0].scan.stamp, 0);
  EXPECT_EQ(read.entries[4].scan.stamp, 400 * kMs);
  EXPECT_TRUE(read.remarks.empty());
}

TEST(OddRecordings, OtherTypesAreNamedWithTheirTopics) {
  const ReadText read = read_messages({{"/cloud", "sensor_msgs/msg/PointCloud2", kStart, "\1\2"}});
  EXPECT_TRUE(read.entries.empty());
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_THAT(read.remarks[0].text, HasSubstr("/cloud (sensor_msgs/msg/PointCloud2)"));
}

std::string multi_echo(bool ros1) {
  test::Wire wire = test::Wire::make(ros1);
  wire.header(kStart, "laser");
  for (const float value : {-1.0F, 1.0F, 1.0F, 0.0F, 0.1F, 0.1F, 12.0F}) wire.put(value);
  for (int array = 0; array < 2; ++array) {
    wire.put(std::uint32_t{3});
    for (const std::vector<float>& echoes : {std::vector<float>{1.5F, 4.0F}, {}, {2.5F}}) {
      wire.put(static_cast<std::uint32_t>(echoes.size()));
      for (const float echo : echoes) wire.put(echo);
    }
  }
  return wire.bytes;
}

TEST(MultiEcho, TheFirstEchoOfABeamIsItsRange) {
  const test::TempFolder folder;
  for (const bool ros1 : {false, true}) {
    const std::vector<Message> messages{{"/scan",
                                         ros1 ? "sensor_msgs/MultiEchoLaserScan" : "sensor_msgs/msg/MultiEchoLaserScan",
                                         kStart, multi_echo(ros1)}};
    const ReadText read = test::read_log(folder.put("log", ros1 ? test::rosbag1(messages) : test::mcap(messages)));
    ASSERT_EQ(read.entries.size(), 1U) << ros1;
    const Scan& scan = read.entries[0].scan;
    EXPECT_EQ(scan.ranges[0], 1.5F);
    EXPECT_EQ(scan.states[1], BeamState::kInvalid);
    EXPECT_EQ(scan.ranges[2], 2.5F);
    EXPECT_EQ(scan.intensities, (std::vector<float>{1.5F, 0.0F, 2.5F}));
  }
}

// --- foxglove.LaserScan ----------------------------------------------------------------------------------------------

std::string varint(std::uint64_t value) {
  std::string out;
  for (; value > 127; value >>= 7) out += static_cast<char>((value & 127) | 128);
  return out + static_cast<char>(value);
}
std::string field(int number, const std::string& bytes) {
  return varint(static_cast<std::uint64_t>(number) << 3 | 2) + varint(bytes.size()) + bytes;
}
std::string raw_double(double value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string fixed(int number, double value) {
  return varint(static_cast<std::uint64_t>(number) << 3 | 1) + raw_double(value);
}

std::string protobuf_scan() {
  const std::string time = std::string("\x08") + varint(1'600'000'000) + "\x10" + varint(250'000'000);
  return field(1, time) + field(2, "laser") + field(3, field(1, fixed(1, 0.0))) + fixed(4, -1.0) + fixed(5, 1.0) +
         field(6, raw_double(1.5) + raw_double(INFINITY)) + fixed(6, 2.5) +
         field(7, raw_double(10.0) + raw_double(20.0) + raw_double(30.0));
}
const char* const kJsonScan =
    R"({"timestamp": {"sec": 1600000000, "nsec": 250000000}, "frame_id": "laser", "pose": {}, "start_angle": -1.0,)"
    R"( "end_angle": 1.0, "ranges": [1.5, null, 2.5], "intensities": [10, 20, 30]})";

TEST(FoxgloveLaserScan, JsonAndProtobufSayTheSame) {
  const test::TempFolder folder;
  for (const bool json : {true, false}) {
    test::McapStyle style;
    style.encoding = json ? "json" : "protobuf";
    const std::string data = json ? kJsonScan : protobuf_scan();
    const ReadText read =
        test::read_log(folder.put("a.mcap", test::mcap({{"/scan", "foxglove.LaserScan", kStart, data}}, style)));
    ASSERT_EQ(read.entries.size(), 1U) << style.encoding;
    const Scan& scan = read.entries[0].scan;
    EXPECT_EQ(scan.stamp, 1'600'000'000'250'000'000);
    EXPECT_EQ(scan.geometry.angle_min, -1.0);
    EXPECT_EQ(scan.geometry.angle_increment, 1.0);
    EXPECT_EQ(scan.ranges[0], 1.5F);
    EXPECT_FALSE(scan.is_hit(1));
    EXPECT_EQ(scan.ranges[2], 2.5F);
    EXPECT_EQ(scan.intensities, (std::vector<float>{10.0F, 20.0F, 30.0F}));
  }
}

TEST(FoxgloveLaserScan, DamagedMessagesAreDamageAndNothingElse) {
  const test::TempFolder folder;
  for (const bool json : {true, false}) {
    test::McapStyle style;
    style.encoding = json ? "json" : "protobuf";
    const std::string whole = json ? kJsonScan : protobuf_scan();
    for (std::size_t size = 0; size < whole.size(); size += json ? 5 : 1) {
      const ReadText read = test::read_log(
          folder.put("a.mcap", test::mcap({{"/scan", "foxglove.LaserScan", kStart, whole.substr(0, size)}}, style)));
      EXPECT_LE(read.entries.size(), 1U);
      EXPECT_EQ(read.entries.size() + read.damages.size(), 1U) << size;
    }
  }
}

// --- databases -------------------------------------------------------------------------------------------------------

TEST(SqliteHead, WhatLacksItsFirstBytesIsReadAsAWhole) {
  const test::TempFolder folder;
  test::rosbag2_sqlite(folder / "a.db3", test::messages(false, 40));
  const std::size_t whole = test::read_log(folder / "a.db3").entries.size();
  const std::string bytes = test::slurp(folder / "a.db3");
  for (const std::size_t zeros : {16, 100, 512, 4096}) {
    std::string damaged = bytes;
    std::fill_n(damaged.begin(), zeros, '\0');
    const ReadText read = test::read_log(folder.put("b.db3", damaged));
    EXPECT_EQ(read.entries.size(), whole) << zeros;
    ASSERT_FALSE(read.damages.empty());
    EXPECT_EQ(read.damages[0].kind, "bad database");
  }
  EXPECT_THROW(test::read_log(folder.put("zeros", std::string(8192, '\0'))), InputError);
}

TEST(SqliteWal, OfARecorderThatWasKilledIsReadAndNothingIsLeft) {
  const test::TempFolder folder, other;
  test::rosbag2_sqlite(folder / "a.db3", test::messages(false, 5));
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "a.db3").c_str(), &db), SQLITE_OK);
  test::run_sql(db, "PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0;");
  test::run_sql(db,
                "INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp, data FROM messages "
                "WHERE topic_id = (SELECT id FROM topics WHERE name = '/scan')");
  for (const char* name : {"a.db3", "a.db3-wal"}) std::filesystem::copy_file(folder / name, other / name);
  sqlite3_close(db);
  const std::string log_before = test::slurp(other / "a.db3-wal");
  ASSERT_FALSE(log_before.empty());
  const ReadText read = test::read_log(other / "a.db3");
  EXPECT_EQ(read.entries.size(), 10U) << "five in the file, five in its log";
  EXPECT_EQ(test::slurp(other / "a.db3-wal"), log_before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(other.path()), {}), 2);
}

}  // namespace
}  // namespace phasescan::odd_recordings_test
