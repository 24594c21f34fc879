// The three low-cost text formats: geometry, wheel odometry as their robots define it, counters that wrap, bad lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "support/temp.hpp"

namespace phasescan::lowcost_test {
namespace {

struct Read {
  std::vector<LogEntry> entries;
  std::vector<LogDamage> damages;
  std::map<std::string, std::string> facts;
};

Read read_text(const std::string& content, const LogOptions& options = {}) {
  const test::TempFolder folder;
  const auto log = open_log(folder.put("log", content), options);
  Read out;
  while (auto entry = log->next()) out.entries.push_back(std::move(*entry));
  out.damages = log->damages();
  out.facts = log->facts();
  return out;
}

std::string slambot_line(int left, int right, int ms, int range_mm = 1500) {
  std::string line = std::to_string(left) + " " + std::to_string(right) + " " + std::to_string(ms);
  for (int k = 0; k < 360; ++k) line += " " + std::to_string(k == 90 ? 700 : k == 5 ? 0 : range_mm);
  return line + "\n";
}

TEST(LowcostSlambot, IsClockwiseInMillimetresWithTheSensorBehindTheCentre) {
  const Read read = read_text(slambot_line(10, 10, 100));
  ASSERT_EQ(read.entries.size(), 1U);
  const LogEntry& entry = read.entries[0];
  ASSERT_EQ(entry.scan.size(), 360U);
  EXPECT_NEAR(entry.scan.angle(90), -M_PI / 2, 1e-12);
  EXPECT_FLOAT_EQ(entry.scan.ranges[90], 0.7F);
  EXPECT_EQ(entry.scan.states[5], BeamState::kNoReturn);
  EXPECT_NEAR(entry.T_base_laser.x, -0.035, 1e-12);
  EXPECT_EQ(entry.scan.stamp, 100'000'000);
}

TEST(LowcostSlambot, CountersAndClockWrapAndMoreTicksLeftTurnRight) {
  const Read read = read_text(slambot_line(32766, -32767, 65500) + slambot_line(-32766, -32763, 100) +
                              slambot_line(-32762, -32763, 300));
  ASSERT_EQ(read.entries.size(), 3U);
  EXPECT_EQ(read.entries[1].scan.stamp - read.entries[0].scan.stamp, 136'000'000);
  const double metres_per_tick = M_PI * 0.0582 / (1000.0 / 3.0);
  EXPECT_NEAR(read.entries[1].odometry->x, 4 * metres_per_tick, 1e-12);
  EXPECT_NEAR(read.entries[1].odometry->theta, 0.0, 1e-12);
  const double turn_deg = 360 * 58.2 / 190 / (1000.0 / 3.0) / (0.9 * (std::pow(177.0 / 190.0, 2) + 1)) * (4 - 0) / 2.0;
  EXPECT_NEAR(read.entries[2].odometry->theta, -turn_deg * M_PI / 180, 1e-12);
}

TEST(LowcostSlambot, AStepNoRobotMakesIsUnknownMotion) {
  const Read read = read_text(slambot_line(0, 0, 0) + slambot_line(500, 500, 180) + slambot_line(510, 510, 360));
  ASSERT_EQ(read.entries.size(), 3U);
  EXPECT_FALSE(read.entries[1].odometry);
  ASSERT_TRUE(read.entries[2].odometry);
  EXPECT_LT(read.entries[2].odometry->x, 0.02);
  EXPECT_EQ(read.facts.count("odometry steps left out"), 1U);
  EXPECT_TRUE(read.damages.empty());
}

TEST(LowcostSlambot, BadLinesArePassedOverByName) {
  const std::string good = slambot_line(0, 0, 0);
  const Read read = read_text(good + "1 2 3 4\n" + "x" + good + "# words\n" + slambot_line(0, 0, 180) +
                              good.substr(0, good.size() - 9));
  EXPECT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[1].line, 5);
  ASSERT_EQ(read.damages.size(), 3U);
  EXPECT_EQ(read.damages[0].kind, "wrong count");
  EXPECT_THAT(read.damages[0].text, testing::HasSubstr(":2: 4 numbers; expected 363"));
  EXPECT_EQ(read.damages[1].kind, "bad number");
  EXPECT_EQ(read.damages[2].kind, "truncated line");
}

std::string breezy_line(long us, int left, int right) {
  std::string line = std::to_string(us) + " 14710 " + std::to_string(left) + " " + std::to_string(right);
  for (int k = 4; k < 24; ++k) line += k == 7 ? " 170.1" : " 0";
  line += " ";
  for (int k = 0; k < 682; ++k) line += " " + std::to_string(k == 341 ? 0 : k == 342 ? 7 : 2000);
  return line + " 99 \n";
}

TEST(LowcostBreezy, HasTwoHundredFortyDegreesAndWheelOdometry) {
  const Read read = read_text(breezy_line(212387282, 100, 100) + breezy_line(212484734, 100, 300));
  ASSERT_EQ(read.entries.size(), 2U);
  const Scan& scan = read.entries[0].scan;
  ASSERT_EQ(scan.size(), 682U);
  EXPECT_NEAR(scan.angle(0), -120 * M_PI / 180, 1e-12);
  EXPECT_NEAR(scan.angle(681), 120 * M_PI / 180, 1e-12);
  EXPECT_EQ(scan.states[341], BeamState::kNoReturn);
  EXPECT_EQ(scan.states[342], BeamState::kTooNear) << "numbers under 20 mm are the sensor's error codes";
  EXPECT_EQ(scan.stamp, 212387282000);
  const double right = 200 * M_PI / 2000;
  EXPECT_NEAR(read.entries[1].odometry->theta, 0.077 / 0.165 * right, 1e-12);
  EXPECT_NEAR(std::hypot(read.entries[1].odometry->x, read.entries[1].odometry->y), 0.077 * right, 1e-12);
  EXPECT_NEAR(read.entries[0].T_base_laser.x, 0.145, 1e-12);
}

TEST(LowcostPolar, HasAsManyBeamsAsItSaysAndWildNumbersAreOutOfRange) {
  std::string line = "-5.0, -754.3, 89.158";
  for (int k = 0; k < 400; ++k) line += k == 100 ? ", 1.5" : k == 7 ? ", 250000.0" : ", 0.0";
  std::string second = "20.0, 90.0, 0.125";
  for (int k = 0; k < 500; ++k) second += ", 2.0";
  const Read read = read_text(line + "\n" + second + "\n" + second.substr(0, 3000));
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.size(), 400U);
  EXPECT_NEAR(read.entries[0].scan.angle(100), M_PI / 2, 1e-12);
  EXPECT_EQ(read.entries[0].scan.states[7], BeamState::kOutOfRange);
  EXPECT_NEAR(read.entries[0].odometry->theta, 0.0, 1e-12) << "what came before the first scan is no motion of the log";
  EXPECT_NEAR(read.entries[1].odometry->theta, M_PI / 2, 1e-12);
  EXPECT_EQ(read.entries[1].scan.stamp - read.entries[0].scan.stamp, 125'000'000);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_EQ(read.damages[0].kind, "truncated line");
}

TEST(Csv, AScanALineAsRosTopicEchoWritesIt) {
  std::string text =
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angle_min,field.angle_max,"
      "field.angle_increment,field.time_increment,field.scan_time,field.range_min,field.range_max";
  for (int k = 0; k < 5; ++k) text += ",field.ranges" + std::to_string(k);
  text += "\n1600000000000000123,7,1600000000000000123,laser,-1.0,1.0,0.5,0.0,0.1,0.05,10.0,1.0,2.0,inf,0.01,nan\n";
  const Read read = read_text(text);
  ASSERT_EQ(read.entries.size(), 1U);
  const Scan& scan = read.entries[0].scan;
  EXPECT_EQ(scan.stamp, 1600000000000000123);
  EXPECT_DOUBLE_EQ(scan.geometry.angle_min, -1.0);
  EXPECT_DOUBLE_EQ(scan.geometry.angle_increment, 0.5);
  EXPECT_DOUBLE_EQ(scan.geometry.range_max, 10.0);
  EXPECT_FLOAT_EQ(scan.ranges[1], 2.0F);
  EXPECT_EQ(scan.states[2], BeamState::kOutOfRange);
  EXPECT_EQ(scan.states[3], BeamState::kTooNear);
  EXPECT_EQ(scan.states[4], BeamState::kInvalid);
}

/// Three turns of 36 beams, a beam a line, as vendors' tools save them.
std::string beams(const std::string& header, char separator, bool clockwise = false) {
  std::string text = header;
  for (int turn = 0; turn < 3; ++turn) {
    for (int k = 0; k < 36; ++k) {
      const int degrees = (clockwise ? 350 - 10 * k : 10 * k);
      text += std::to_string(degrees) + ".5" + separator + std::to_string(1000 + k + 100 * turn) + separator + "47\n";
    }
  }
  return text;
}

TEST(Csv, ABeamALineIsCutIntoTurnsAndUnitsAreGuessed) {
  for (const bool clockwise : {false, true}) {
    const Read read = read_text(beams("angle,distance,quality\n", ',', clockwise));
    ASSERT_EQ(read.entries.size(), 3U);
    for (std::size_t turn = 0; turn < 3; ++turn) {
      const Scan& scan = read.entries[turn].scan;
      ASSERT_EQ(scan.size(), 36U);
      EXPECT_NEAR(scan.angle(1), (clockwise ? 340.5 : 10.5) * M_PI / 180, 1e-6);
      EXPECT_FLOAT_EQ(scan.ranges[0], 1.0F + 0.1F * static_cast<float>(turn));
      EXPECT_FLOAT_EQ(scan.intensities[0], 47.0F);
      EXPECT_EQ(scan.stamp, static_cast<Stamp>(turn) * 100'000'000);
    }
    EXPECT_THAT(read.facts.at("assumed units"),
                testing::AllOf(testing::HasSubstr("degrees"), testing::HasSubstr("mm")));
  }
}

TEST(Csv, AHeaderMayStandInACommentAndColumnsMayBeNamed) {
  EXPECT_EQ(read_text(beams("#RPLIDAR SCAN DATA\n#COUNT=108\n#Angule\tDistance\tQuality\n", ' ')).entries.size(), 3U);
  const Read named = read_text(beams("", ' '), {.topic = "", .columns = "angle_deg_cw,range_mm,quality"});
  ASSERT_EQ(named.entries.size(), 3U);
  EXPECT_NEAR(named.entries[0].scan.angle(1), -10.5 * M_PI / 180, 1e-6);
  EXPECT_FLOAT_EQ(named.entries[0].scan.ranges[0], 1.0F);
}

TEST(Csv, ScansByNumberStampsInAnyUnitAndOdometry) {
  const Read read = read_text(
      "scan;time_ms;angle_rad;range_m;odom_x;odom_y;odom_theta\n"
      "1;1600000000100;0.0;1;0.5;0.25;0.1\n1;1600000000100;0.1;2;0.5;0.25;0.1\n2;1600000000200;0.0;3;1;0;0\n2;1600000000200;0.1;;1;0;0\n");
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.stamp, 1600000000100000000);
  EXPECT_EQ(read.entries[0].scan.size(), 2U);
  EXPECT_NEAR(read.entries[0].odometry->y, 0.25, 1e-12);
  EXPECT_EQ(read.entries[1].scan.states[1], BeamState::kNoReturn);
}

TEST(Csv, AllThatFollowsMayBeRanges) {
  const Read read = read_text("1.5 1.0 2.0 3.0\n1.6 1.0 2.0\n", {.topic = "", .columns = "stamp,ranges"});
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.size(), 3U);
  EXPECT_EQ(read.entries[1].scan.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.stamp, 1'500'000'000);
  EXPECT_NEAR(read.entries[0].scan.angle(1), 2 * M_PI / 3, 1e-6);
}

TEST(Csv, BadRowsAreNamedAndNamesThatMakeNoLogAreRefused) {
  const Read read = read_text("stamp,r0,r1\n1,1,2\n2,1\n3,1,zwei\n4,1,2\n");
  EXPECT_EQ(read.entries.size(), 2U);
  ASSERT_EQ(read.damages.size(), 2U);
  EXPECT_THAT(read.damages[0].text, testing::HasSubstr(":3: 2 fields; expected 3"));
  EXPECT_THAT(read.damages[1].text, testing::HasSubstr(":4: field 3 is 'zwei'"));
  EXPECT_THROW(read_text("1,2\n", {.topic = "", .columns = "stamp,range"}), InputError);
  EXPECT_THROW(read_text("1,2\n3,4\n"), InputError);
}

}  // namespace
}  // namespace phasescan::lowcost_test
