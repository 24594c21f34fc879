// What terminals and small programs print: topic echo, ultra_simple, S lines, SICK telegrams.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phasescan/core/pose2.hpp"
#include "support/read_text.hpp"

namespace phasescan::printed_logs_test {
namespace {

using test::read_text;
using test::ReadText;
using ::testing::HasSubstr;

std::string echo_ros1(int secs, const std::string& ranges) {
  return "header: \n  seq: 4\n  stamp: \n    secs: " + std::to_string(secs) +
         "\n    nsecs: 250000000\n  frame_id: \"laser\"\nangle_min: -1.0\nangle_max: 1.0\nangle_increment: 0.5\n"
         "time_increment: 0.0\nscan_time: 0.0\nrange_min: 0.1\nrange_max: 30.0\nranges: [" +
         ranges + "]\nintensities: []\n---\n";
}

std::string echo_ros2(int sec, const std::string& ranges, const std::string& intensities) {
  return "header:\n  stamp:\n    sec: " + std::to_string(sec) +
         "\n    nanosec: 5\n  frame_id: laser\nangle_min: -1.0\nangle_max: 1.0\nangle_increment: 0.5\n"
         "time_increment: 0.001\nscan_time: 0.1\nrange_min: 0.1\nrange_max: 30.0\nranges:\n" +
         ranges + "intensities:" + intensities + "\n---\n";
}

TEST(TopicEcho, TextOfRos1IsRead) {
  const ReadText read = read_text("WARNING: no messages\n" + echo_ros1(1055, "1.5, inf, 0.05, nan, 2.0") +
                                  echo_ros1(1056, "1.0, 1.0, 1.0, 1.0, 1.0"));
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_TRUE(read.damages.empty());
  const Scan& scan = read.entries[0].scan;
  EXPECT_EQ(scan.stamp, 1'055'250'000'000);
  EXPECT_EQ(scan.geometry.angle_min, -1.0);
  EXPECT_EQ(scan.geometry.angle_increment, 0.5);
  EXPECT_EQ(scan.ranges[0], 1.5F);
  EXPECT_EQ(scan.states[1], BeamState::kOutOfRange);
  EXPECT_EQ(scan.states[2], BeamState::kTooNear);
  EXPECT_EQ(scan.states[3], BeamState::kInvalid);
  EXPECT_EQ(read.entries[1].line, 18);
}

TEST(TopicEcho, TextOfRos2IsRead) {
  const std::string ranges = "- 1.5\n- .inf\n- .nan\n- 3.0\n- -.inf\n";
  const ReadText read =
      read_text(echo_ros2(7, ranges, "\n- 1.0\n- 2.0\n- .nan\n- 4.0\n- 5.0") + echo_ros2(8, ranges, " []"));
  ASSERT_EQ(read.entries.size(), 2U);
  const Scan& scan = read.entries[0].scan;
  EXPECT_EQ(scan.stamp, 7'000'000'005);
  EXPECT_EQ(scan.states[1], BeamState::kOutOfRange);
  EXPECT_EQ(scan.states[2], BeamState::kInvalid);
  EXPECT_EQ(scan.states[4], BeamState::kTooNear);
  EXPECT_EQ(scan.intensities, (std::vector<float>{1.0F, 2.0F, 0.0F, 4.0F, 5.0F}));
  EXPECT_TRUE(read.entries[1].scan.intensities.empty());
}

TEST(TopicEcho, WhatWasPrintedShortenedSaysWhatToType) {
  const ReadText read = read_text(echo_ros2(7, "- 1.5\n- 2.0\n- '...'\n", " []") + echo_ros1(9, "1, 1, 1, 1, 1"));
  EXPECT_EQ(read.entries.size(), 1U);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_THAT(read.damages[0].text,
              HasSubstr(":16: the arrays were printed shortened; expected `ros2 topic echo --full-length`"));
}

TEST(TopicEcho, AMessageCutOffIsDamageAndTheOthersAreRead) {
  const std::string whole = echo_ros1(1, "1, 2, 3, 4, 5"), last = echo_ros1(2, "1, 2, 3, 4, 5");
  for (std::size_t size = 1; size < last.size(); ++size) {
    const ReadText read = read_text(whole + last.substr(0, size));
    ASSERT_GE(read.entries.size(), 1U) << size;
    EXPECT_LE(read.entries.size() + read.damages.size(), 2U) << size;
    if (read.entries.size() == 2) {
      EXPECT_EQ(read.entries[1].scan.size(), 5U) << size;
    }
  }
  EXPECT_EQ(read_text(whole + last.substr(0, last.size() - 4)).entries.size(), 2U) << "all but ---";
  const ReadText bad = read_text(echo_ros1(1, "1, x, 3, 4, 5") + whole);
  EXPECT_EQ(bad.entries.size(), 1U);
  EXPECT_THAT(bad.damages.at(0).text, HasSubstr("'x' stands among the numbers"));
}

TEST(EchoCsv, ALineIsAMessage) {
  const std::string head = "17,936477184,velodyne,-1.0,1.0,0.5,0.0,0.0,0.1,200.0";
  const ReadText read = read_text(head + ",1,2,3,4,inf\n" + head + ",1,2,3,4,5,10,20,30,40,50\n" + head + ",1,2\n");
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.stamp, 17'936'477'184);
  EXPECT_EQ(read.entries[0].scan.size(), 5U);
  EXPECT_EQ(read.entries[0].scan.states[4], BeamState::kOutOfRange);
  EXPECT_TRUE(read.entries[0].scan.intensities.empty());
  EXPECT_EQ(read.entries[1].scan.intensities[4], 50.0F);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_THAT(read.damages[0].text, HasSubstr(":3: 2 numbers behind the head do not fit"));
  EXPECT_THAT(read_text(head + ",1,2,3,4,5\n" + head + ",1,2,'...'\n").damages.at(0).text, HasSubstr("--full-length"));
}

TEST(UltraSimple, IsClockwiseInDegreesAndMillimetresAndSBeginsATurn) {
  const ReadText read = read_text(
      "Ultra simple LIDAR data grabber for RPLIDAR.\nVersion: 1.11.0\n   theta: 350.00 Dist: 01000.00 Q: 47 \n"
      "S  theta: 0.50 Dist: 02000.00 Q: 47 \n   theta: 90.00 Dist: 00000.00 Q: 0 \n   theta: x\n"
      "S  theta: 0.75 Dist: 03000.00 Q: 15 \n");
  ASSERT_EQ(read.entries.size(), 3U);
  EXPECT_EQ(read.format, "printout of ultra_simple");
  const Scan& turn = read.entries[1].scan;
  ASSERT_EQ(turn.size(), 2U);
  EXPECT_NEAR(turn.angle(1), -kPi / 2.0, 1e-6);
  EXPECT_FLOAT_EQ(turn.ranges[0], 2.0F);
  EXPECT_EQ(turn.states[1], BeamState::kNoReturn);
  EXPECT_EQ(turn.intensities[0], 47.0F);
  EXPECT_EQ(read.entries[2].scan.stamp - turn.stamp, 100'000'000);
  EXPECT_TRUE(read.has_remark("assumed stamps"));
  EXPECT_EQ(read.damages.size(), 1U);
}

TEST(SLines, AreReadAmongOthers) {
  const ReadText read =
      read_text("P 1 2 3\nS 315 5 100 200 300 0 500\nM 316 1 2\nS 551 5 1 2 3 4\nS 551 5 1 2 3 4 5\n");
  ASSERT_EQ(read.entries.size(), 2U);
  const Scan& scan = read.entries[0].scan;
  EXPECT_EQ(scan.stamp, 315'000'000);
  EXPECT_FLOAT_EQ(scan.ranges[2], 0.3F);
  EXPECT_NEAR(scan.angle(2), 0.0, 1e-12);
  EXPECT_NEAR(scan.angle(3) - scan.angle(2), kTwoPi / 1024, 1e-9);
  EXPECT_EQ(read.damages.size(), 1U);
}

std::string telegram(const std::string& start_us, const std::string& layer = "0") {
  return "sRA LMDscandata 0 1 1160456 0 0 9506 951E " + start_us + " 36B9DCCD 0 0 3F 0 " + layer +
         " 1388 21C 1 0 0 1 DIST1 40000000 00000000 FFFF3CB0 1388 3 64 0 3E8 1 RSSI1 3F800000 00000000 FFFF3CB0 1388 3 A B C "
         "0 1 B SN 18220118 0 0 0";
}

TEST(Sick, TelegramsOfColaA) {
  const ReadText read =
      read_text("\x02" + telegram("FFFFFFFF") + "\x03\x02" + telegram("3E7") + "\x03\n" +
                "sRA LMDscandata 0 1 zz\n\x02sAN mLMPsetscancfg\x03\n" + telegram("7CF", "9C4") + "\n");
  ASSERT_EQ(read.entries.size(), 2U);
  const Scan& scan = read.entries[0].scan;
  ASSERT_EQ(scan.size(), 3U);
  EXPECT_NEAR(scan.angle(0), deg_to_rad(-5.0 - 90.0), 1e-9);
  EXPECT_NEAR(scan.angle(1) - scan.angle(0), deg_to_rad(0.5), 1e-9);
  EXPECT_FLOAT_EQ(scan.ranges[0], 0.2F) << "the scale is 2: 100 steps of 2 mm";
  EXPECT_EQ(scan.states[1], BeamState::kNoReturn);
  EXPECT_EQ(scan.intensities, (std::vector<float>{10.0F, 11.0F, 12.0F}));
  EXPECT_EQ(read.entries[1].scan.stamp - scan.stamp, 1'000'000) << "the sensor's clock of 32 bits went round";
  EXPECT_EQ(read.damages.size(), 1U);
  EXPECT_TRUE(read.has_remark("tilted laser")) << "the second layer looks out of the plane";
}

}  // namespace
}  // namespace phasescan::printed_logs_test
