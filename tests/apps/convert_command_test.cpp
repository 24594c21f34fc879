// convert and info from outside: every target reads back as the same scans, damage is exit 4, files appear whole or not
// at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "phasescan/io/log.hpp"
#include "support/command.hpp"
#include "support/ros_fixture.hpp"

namespace phasescan::convert_command_test {
namespace {

using test::run_command;
using test::TempFolder;
using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'600'000'000'000'000'000;

std::vector<test::Message> messages() {
  std::vector<test::Message> out;
  for (int k = 0; k < 10; ++k) {
    const std::int64_t t = kStart + k * 100'000'000;
    std::vector<float> ranges(91, 2.0F);
    ranges[static_cast<std::size_t>(k)] = 1.25F;
    ranges[80] = 0.0F;
    out.push_back({"/odom", "nav_msgs/msg/Odometry", t, test::odometry(false, t, 0.1 * k, 0.5, 0.2)});
    out.push_back({"/scan", "sensor_msgs/msg/LaserScan", t, test::laser_scan(false, t, ranges)});
  }
  return out;
}

TEST(ConvertCommand, PosesOfAMappingProgramDoNotBecomeOdometry) {
  const TempFolder folder;
  std::string text = "NEFF 12 1 0 0 host 0\n";
  for (int k = 0; k < 5; ++k) {
    const std::string pose = std::to_string(0.1 * k) + " 0 0";
    text += "FLASER 4 2 2 2 2 " + pose + " " + pose + " " + std::to_string(100 + k) + " host 0\n";
  }
  const auto result = run_command({"convert", folder.put("in.log", text), folder / "out.jsonl"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("not written as odometry"));
  const auto log = open_log(folder / "out.jsonl");
  for (int k = 0; k < 5; ++k) {
    const auto entry = log->next();
    ASSERT_TRUE(entry);
    EXPECT_FALSE(entry->odometry);
  }
}

TEST(ConvertCommand, AScanLogHoldsTheOdometryOfTheLaser) {
  const TempFolder folder;
  const auto result = run_command(
      {"convert",
       folder.put("in.log", "PARAM robot_frontlaser_offset 0.3 host 0\nFLASER 4 2 2 2 2 0 0 0 1 2 0 100 host 0\n"),
       folder / "out.jsonl"});
  EXPECT_EQ(result.code, 0) << result.err;
  const auto entry = open_log(folder / "out.jsonl")->next();
  ASSERT_TRUE(entry && entry->odometry);
  EXPECT_NEAR(entry->odometry->x, 1.3, 1e-9);
  EXPECT_NEAR(entry->odometry->y, 2.0, 1e-9);
}

TEST(ConvertCommand, EveryLogFormatReadsBackAsTheSameScans) {
  const TempFolder folder;
  test::write_bytes(folder / "in", test::mcap(messages()));
  for (const char* name : {"out.mcap", "out.log", "out.log.gz", "out.jsonl", "out.jsonl.gz"}) {
    SCOPED_TRACE(name);
    const auto result = run_command({"convert", folder / "in", folder / name});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto log = open_log(folder / name);
    for (int k = 0; k < 10; ++k) {
      const auto entry = log->next();
      ASSERT_TRUE(entry);
      EXPECT_EQ(entry->scan.stamp, kStart + k * 100'000'000);
      ASSERT_EQ(entry->scan.size(), 91U);
      EXPECT_EQ(entry->scan.ranges[static_cast<std::size_t>(k)], 1.25F);
      EXPECT_EQ(entry->scan.hit_count(), 90U);
      EXPECT_FLOAT_EQ(static_cast<float>(entry->scan.geometry.angle_increment), 3.0F / 90);
      ASSERT_TRUE(entry->odometry);
      EXPECT_NEAR(entry->odometry->x, 0.1 * k, 1e-12);
      EXPECT_NEAR(entry->odometry->theta, 0.2, 1e-12);
    }
    EXPECT_FALSE(log->next());
    EXPECT_EQ(log->damage_count(), 0U);
  }
  const auto tum = run_command({"convert", folder / "in", folder / "out.tum"});
  EXPECT_EQ(tum.code, 0);
  EXPECT_THAT(test::slurp(folder / "out.tum"),
              testing::StartsWith("1600000000.000000000 0.000000 0.500000 0 0 0 0.0998334"));
}

TEST(ConvertCommand, ALaserUpsideDownIsWrittenAsWhatItSees) {
  const TempFolder folder;
  auto all = messages();
  all.insert(all.begin(), {"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
                           test::transforms(false, {{kStart, "base_link", "laser", 0.2, 0, {1, 0, 0, 0}}})});
  test::write_bytes(folder / "in", test::mcap(all));
  ASSERT_EQ(run_command({"convert", folder / "in", folder / "out.jsonl"}).code, 0);
  ASSERT_EQ(run_command({"convert", folder / "in", folder / "out.mcap"}).code, 0);
  const auto upright = open_log(folder / "out.jsonl")->next();
  EXPECT_NEAR(upright->scan.angle(0), 1.5, 1e-6);
  EXPECT_LT(upright->scan.geometry.angle_increment, 0.0);
  const auto flipped = open_log(folder / "out.mcap")->next();
  EXPECT_TRUE(flipped->flipped);
  EXPECT_NEAR(flipped->scan.angle(0), -1.5, 1e-6);
}

TEST(ConvertCommand, SaysWhatTheOtherFormatCannotHold) {
  const TempFolder folder;
  const std::string scan = folder.put(
      "scan",
      R"({"angle_min": 0, "angle_increment": 0.1, "range_min": 0.2, "ranges": [1, 2, 3], "time_increment": 0.001})");
  const auto run = run_command({"convert", scan, folder / "out.log"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, HasSubstr("no time between beams"));
  EXPECT_THAT(run.err, HasSubstr("no smallest range"));
  EXPECT_EQ(run_command({"convert", scan, folder / "out.jsonl"}).err, "");
}

TEST(ConvertCommand, AMapIsBothItsFilesOrNone) {
  const TempFolder folder;
  test::write_bytes(folder / "in", test::mcap(messages()));
  std::filesystem::create_directory(folder / "out.yaml");
  EXPECT_EQ(run_command({"convert", folder / "in", folder / "out.pgm"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.pgm"));
  std::filesystem::remove(folder / "out.yaml");
  EXPECT_EQ(run_command({"convert", folder / "in", folder / "out.pgm"}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out.pgm") && std::filesystem::exists(folder / "out.yaml"));
}

TEST(ConvertCommand, SaysWhatItDidNotRead) {
  const TempFolder folder;
  const std::string whole = test::mcap(messages());
  test::write_bytes(folder / "cut", whole.substr(0, whole.size() * 2 / 3));
  const auto cut = run_command({"convert", folder / "cut", folder / "out.jsonl"});
  EXPECT_EQ(cut.code, 4);
  EXPECT_THAT(cut.err, HasSubstr("warning"));
  EXPECT_TRUE(open_log(folder / "out.jsonl")->next());

  test::write_bytes(folder / "nothing", whole.substr(0, 60));
  const auto nothing = run_command({"convert", folder / "nothing", folder / "none.jsonl"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.jsonl"));

  EXPECT_EQ(run_command({"convert", folder / "cut", folder / "out.docx"}).code, 2);
  EXPECT_EQ(run_command({"convert", folder / "absent", folder / "out.jsonl"}).code, 2);
  EXPECT_EQ(run_command({"convert", folder / "cut", folder / "no/such/out.jsonl"}).code, 2);
  EXPECT_EQ(run_command({"convert", folder / "cut", folder / "out", "--to", "docx"}).code, 2);
}

TEST(InfoCommand, NamesWhatIsWrongAndWhatToDo) {
  const TempFolder folder;
  auto all = messages();
  std::swap(all[5], all[15]);
  test::write_bytes(folder / "in", test::mcap(all));
  const auto result = run_command({"info", folder / "in"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("finding: stamps backwards"));
  EXPECT_THAT(result.out, HasSubstr("topic /scan"));
}

}  // namespace
}  // namespace phasescan::convert_command_test
