#include "phasescan/io/log.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "phasescan/io/error.hpp"
#include "io/scan_log.hpp"
#include "support/data.hpp"
#include "support/nobody.hpp"
#include "support/temp.hpp"

namespace phasescan::log_test {
namespace {

using ::testing::HasSubstr;

struct ReadLog {
  std::vector<LogEntry> entries;
  std::vector<LogDamage> damages;
  std::map<std::string, std::string> facts;
  std::string format;
};

ReadLog read_all(const std::string& path) {
  const auto reader = open_log(path);
  ReadLog out;
  while (auto entry = reader->next()) out.entries.push_back(std::move(*entry));
  out.damages = reader->damages();
  out.facts = reader->facts();
  out.format = reader->format();
  return out;
}

LogEntry an_entry(int k) {
  LogEntry entry;
  std::vector<float> raw(30);
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = i % 5 == 0 ? 0.0F : 1.0F + 0.1F * static_cast<float>(i) + 0.01F * static_cast<float>(k);
  entry.scan = make_scan(raw, {-1.0, -0.05, 0.1, 6.0});
  entry.scan.stamp = 1'700'000'000'000'000'001 + k * 100'000'000LL;
  if (k % 2 == 0) entry.odometry = Pose2{0.1 * k, -0.2, 0.3};
  return entry;
}

TEST(ScanLog, PlainAndPackedReadBackTheSame) {
  const test::TempFolder folder;
  for (const char* name : {"l.jsonl", "l.jsonl.gz", "named like nothing"}) {
    ScanLogWriter writer(folder / name);
    for (int k = 0; k < 20; ++k) writer.write(an_entry(k));
    writer.commit();
    const ReadLog log = read_all(folder / name);
    EXPECT_EQ(log.format, "scan log");
    EXPECT_TRUE(log.damages.empty());
    ASSERT_EQ(log.entries.size(), 20U);
    for (int k = 0; k < 20; ++k) {
      const LogEntry& entry = log.entries[static_cast<std::size_t>(k)];
      EXPECT_EQ(format_log_line(entry), format_log_line(an_entry(k)));
      EXPECT_EQ(entry.scan.stamp, an_entry(k).scan.stamp);
      EXPECT_EQ(entry.odometry.has_value(), k % 2 == 0);
      EXPECT_EQ(entry.line, k + 1);
    }
  }
}

TEST(ScanLog, OdometryOfTheBaseIsWrittenAsTheLasers) {
  LogEntry entry = an_entry(2);
  entry.odometry = Pose2{1.0, 2.0, kPi / 2};
  entry.T_base_laser = {0.5, 0.0, 0.0};
  const test::TempFolder folder;
  const ReadLog log = read_all(folder.put("l", format_log_line(entry)));
  ASSERT_EQ(log.entries.size(), 1U);
  EXPECT_NEAR(log.entries[0].odometry->x, 1.0, 1e-12);
  EXPECT_NEAR(log.entries[0].odometry->y, 2.5, 1e-12);
}

TEST(ScanLog, ADamagedLineIsCountedAndTheRestIsRead) {
  const test::TempFolder folder;
  const std::string good = format_log_line(an_entry(1));
  const ReadLog log = read_all(
      folder.put("l", good + "\n{\"ranges\": 3}\n" + good + "\n\nrubbish\n" + good + "\n" + good.substr(0, 60)));
  EXPECT_EQ(log.entries.size(), 3U);
  ASSERT_EQ(log.damages.size(), 3U);
  EXPECT_EQ(log.damages[0].kind, "bad line");
  EXPECT_THAT(log.damages[0].text, HasSubstr("l:2: \"ranges\" is"));
  EXPECT_THAT(log.damages[1].text, HasSubstr("l:5: is not JSON"));
  EXPECT_EQ(log.damages[2].kind, "truncated line");
}

TEST(ScanLog, OneScanOverSeveralLinesIsALogOfOne) {
  const test::TempFolder folder;
  const ReadLog log =
      read_all(folder.put("s.json", "{\n \"angle_min\": 0,\n \"angle_increment\": 0.1,\n \"ranges\": [1,\n2]\n}\n"));
  ASSERT_EQ(log.entries.size(), 1U);
  EXPECT_EQ(log.entries[0].scan.size(), 2U);
}

std::string flaser(int beams, const std::string& tail = "1 2 0.5 1.5 2.5 0.25 100.25 host 5.5") {
  std::string line = "FLASER " + std::to_string(beams);
  for (int i = 0; i < beams; ++i) line += i == 3 ? " 81.83" : i == 4 ? " 80.00" : " 2.50";
  return line + " " + tail + "\n";
}

TEST(Carmen, FlaserSecondPoseIsOdometryOfTheBaseOnceTheOffsetIsKnown) {
  const test::TempFolder folder;
  const ReadLog log =
      read_all(folder.put("l", "# CARMEN Logfile\n" + flaser(180) +
                                   "PARAM robot_frontlaser_offset 0.5 nohost 0\nSYNC x\nNEFF 1 2\n" + flaser(181)));
  EXPECT_EQ(log.format, "carmen");
  EXPECT_TRUE(log.damages.empty());
  ASSERT_EQ(log.entries.size(), 2U);
  const LogEntry& plain = log.entries[0];
  EXPECT_EQ(plain.laser, "FLASER");
  EXPECT_EQ(plain.line, 2);
  EXPECT_EQ(plain.scan.stamp, 100'250'000'000);
  EXPECT_DOUBLE_EQ(plain.scan.angle(0), -kPi / 2);
  EXPECT_NEAR(plain.scan.angle(179), kPi / 2 - kPi / 180, 1e-12);
  EXPECT_EQ(plain.scan.states[3], BeamState::kNoReturn);
  EXPECT_EQ(plain.scan.states[4], BeamState::kNoReturn);
  EXPECT_EQ(plain.scan.hit_count(), 178U);
  EXPECT_DOUBLE_EQ(plain.corrected->x, 1.0);
  EXPECT_DOUBLE_EQ(plain.odometry->x, 1.5);
  const LogEntry& mounted = log.entries[1];
  EXPECT_NEAR(mounted.scan.angle(180), kPi / 2, 1e-12);
  EXPECT_DOUBLE_EQ(mounted.T_base_laser.x, 0.5);
  EXPECT_NEAR(mounted.odometry->x, 1.5 - 0.5 * std::cos(0.25), 1e-12);
  EXPECT_NEAR(mounted.odometry->y, 2.5 - 0.5 * std::sin(0.25), 1e-12);
}

/// ODOM every `odom_s` and RAWLASER1 every 0.1 s for 6 s at 1 m/s; the scans' clock is `ahead_s` ahead.
std::string slow_carmen_odometry(double odom_s, double ahead_s) {
  std::string text;
  double next = 0.0;
  for (int k = 0; k <= 60; ++k) {
    const double t = 0.1 * k;
    if (t >= next - 1e-9) {
      text += fmt::format("ODOM {:.3f} 0 0 1 0 0 {:.3f} host {:.3f}\n", t, 100.0 + t, t);
      next += odom_s;
    }
    text += fmt::format("RAWLASER1 0 -1.0 2.0 0.5 10.0 0.01 0 4 1.0 2.0 2.0 2.5 0 {:.3f} host {:.3f}\n",
                        100.0 + ahead_s + t, t);
  }
  return text;
}

TEST(Carmen, OdometrySlowerThanTheScansIsInterpolated) {
  const test::TempFolder folder;
  const ReadLog log = read_all(folder.put("l", slow_carmen_odometry(0.5, 0.03)));
  EXPECT_TRUE(log.damages.empty());
  ASSERT_EQ(log.entries.size(), 61U);
  for (std::size_t k = 0; k < 60; ++k) {
    ASSERT_TRUE(log.entries[k].odometry.has_value()) << k;
    EXPECT_NEAR(log.entries[k].odometry->x, 0.1 * static_cast<double>(k) + 0.03, 1e-9) << k;
  }
}

TEST(Carmen, OdometryThatIsTooRareOrOfAnotherClockIsNotUsed) {
  const test::TempFolder folder;
  const auto with = [](const ReadLog& log) {
    return std::count_if(log.entries.begin(), log.entries.end(),
                         [](const LogEntry& e) { return e.odometry.has_value(); });
  };
  const ReadLog rare = read_all(folder.put("l", slow_carmen_odometry(3.0, 0.0)));
  EXPECT_LE(with(rare), 3 * 5) << "at its own time and 0.2 s about it";
  EXPECT_EQ(rare.entries.size(), 61U);
  const std::string path = folder.put("m", slow_carmen_odometry(0.1, 3600.0));
  const auto reader = open_log(path);
  std::size_t scans = 0, used = 0;
  while (const auto entry = reader->next()) ++scans, used += entry->odometry.has_value();
  EXPECT_EQ(scans, 61U);
  EXPECT_EQ(used, 0U);
  ASSERT_EQ(reader->remarks().size(), 1U);
  EXPECT_EQ(reader->remarks()[0].kind, "odometry of another clock");
  EXPECT_THAT(reader->remarks()[0].text, HasSubstr("3600.0 s before"));
}

TEST(Carmen, BothRobotLaserDialectsAndRawLaserGiveTheSameScan) {
  const test::TempFolder folder;
  const std::string head = " 0 -1.0 2.0 0.5 10.0 0.01 0 4 1.0 2.0 10.0 12.5 ";
  const std::string poses = "1 0 0 0.5 0 0 0.1 0.2 0.3 0.4 ";
  const ReadLog log = read_all(folder.put("l", "ROBOTLASER1" + head + "0 " + poses + "0.0 7.5 host 1\n" +  // newer
                                                   "ROBOTLASER1" + head + poses + "7.5 host 1\n" +         // older
                                                   "ROBOTLASER2" + head + "4 9 8 7 6 " + poses +
                                                   "0.0 7.5 host 1\n"  // remissions
                                                   "ODOM 3 4 0.5 0 0 0 7.4 host 1\n"
                                                   "RAWLASER1" +
                                                   head + "0 7.5 host 1\n"));
  EXPECT_TRUE(log.damages.empty()) << log.damages[0].text;
  ASSERT_EQ(log.entries.size(), 4U);
  for (const LogEntry& entry : log.entries) {
    EXPECT_EQ(entry.scan.stamp, 7'500'000'000);
    EXPECT_EQ(entry.scan.hit_count(), 2U);
    EXPECT_DOUBLE_EQ(entry.scan.angle(3), 0.5);
    EXPECT_DOUBLE_EQ(entry.scan.geometry.range_max, 10.0);
    ASSERT_TRUE(entry.odometry.has_value());
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(log.entries[static_cast<std::size_t>(i)].odometry->x, 0.5);
    EXPECT_DOUBLE_EQ(log.entries[static_cast<std::size_t>(i)].T_base_laser.x, 0.5);
  }
  EXPECT_EQ(log.entries[2].scan.intensities, (std::vector<float>{9, 8, 7, 6}));
  EXPECT_EQ(log.entries[2].laser, "ROBOTLASER2");
  EXPECT_DOUBLE_EQ(log.entries[3].odometry->y, 4.0);
}

TEST(Carmen, WholeSecondsWithMicrosecondsBehindTheHost) {
  const test::TempFolder folder;
  const ReadLog log = read_all(folder.put("l", flaser(5, "0 0 0 0 0 0 976052857 host 337557")));
  ASSERT_EQ(log.entries.size(), 1U);
  EXPECT_EQ(log.entries[0].scan.stamp, 976'052'857'337'557'000);
}

TEST(Carmen, EveryKindOfBadLineIsNamedAndTheGoodOnesRead) {
  struct Case {
    std::string line, kind, reason;
  };
  const std::vector<Case> cases{
      {"FLASER\n", "truncated line", "ends too early"},
      {"FLASER x 1 2\n", "wrong count", "'x'; expected a count"},
      {"FLASER -3 1 2\n", "wrong count", "expected a count"},
      {"FLASER 10000000 1 2\n", "wrong count", "expected at most 1000000"},
      {"FLASER 99999999999999999999 1\n", "wrong count", "expected a count"},
      {"FLASER 3 1 2 3 0 0 0 0 0 0 1 host\n", "wrong count", "expected 12"},
      {"FLASER 3 1 2 3 4 0 0 0 0 0 0 1 host 1\n", "wrong count", "expected 12"},
      {"FLASER 3 1 two 3 0 0 0 0 0 0 1 host 1\n", "non-number", "a range is 'two'"},
      {"FLASER 3 1 2 3 0 0 nan 0 0 0 1 host 1\n", "bad value", "the laser pose"},
      {"FLASER 3 1 2 3 0 0 0 0 inf 0 1 host 1\n", "bad value", "the odometry"},
      {"FLASER 3 1 2 3 0 0 0 0 0 0 now host 1\n", "bad value", "the time is 'now'"},
      {"FLASER 3 1 2 3 0 0 0 0 0 0 1e300 host 1\n", "bad value", "the time"},
      {"RAWLASER1 0 -1 0 0 10 0 0 2 1 1 0 1 host 1\n", "bad value", "resolution and field of view are 0"},
      {"RAWLASER1 0 -1 2 1 10 0 0 2 1 1 7 1 host 1\n", "wrong count", "expected 10"},
      {"ROBOTLASER1 0 -1 2 1 10 0 0 2 1 1 1 0 0 0.5\n", "wrong count", "expected 15"},
      {"ROBOTLASER1 0 nan 2 1 10 0 0 2 1 1 0 1 0 0 0.5 0 0 0 0 0 0 0 7.5 host 1\n", "bad value", "the start angle"},
      {"ODOM 1 nan 0\n", "bad value", "the odometry"},
  };
  for (const Case& c : cases) {
    const test::TempFolder folder;
    const ReadLog log = read_all(folder.put("l", flaser(5) + c.line + flaser(5)));
    EXPECT_EQ(log.entries.size(), 2U) << c.line;
    ASSERT_EQ(log.damages.size(), 1U) << c.line;
    EXPECT_EQ(log.damages[0].kind, c.kind) << c.line;
    EXPECT_THAT(log.damages[0].text, HasSubstr("l:2: ")) << c.line;
    EXPECT_THAT(log.damages[0].text, HasSubstr(c.reason)) << c.line;
  }
}

TEST(Carmen, RangesThatAreNoDistanceAreMissing) {
  const test::TempFolder folder;
  const ReadLog log = read_all(folder.put("l", "FLASER 6 nan inf -inf -2 0 3 0 0 0 0 0 0 1 host 1\n"));
  ASSERT_EQ(log.entries.size(), 1U);
  EXPECT_EQ(log.entries[0].scan.hit_count(), 1U);
}

TEST(Log, WhatIsNoLogIsRefusedWithItsPlace) {
  const test::TempFolder folder;
  const auto message = [](const std::string& path) -> std::string {
    try {
      open_log(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(message(folder.put("empty", "")), HasSubstr("empty:1: the file is empty"));
  EXPECT_THAT(message(folder.put("words", "once upon a time\n")),
              HasSubstr("words:1: is of no known format; expected one of"));
  EXPECT_THAT(message(folder.path()), HasSubstr("is a folder"));
  EXPECT_THAT(message(folder / "absent"), HasSubstr("no such file"));
  EXPECT_THAT(message(folder.put("p", "{\"id\": 1, \"reference\": {}}\n")), HasSubstr("p:1: is a pairs file"));
  EXPECT_THAT(message(folder.put("broken.gz", std::string("\x1f\x8b\x08\x00", 4) + "rubbish rubbish rubbish")),
              HasSubstr("gzip: the data is broken"));
}

TEST(Log, ACutOffPackedLogIsReadAsFarAsItGoes) {
  const test::TempFolder folder;
  ScanLogWriter writer(folder / "l.gz");
  for (int k = 0; k < 3000; ++k) writer.write(an_entry(k));
  writer.commit();
  std::filesystem::resize_file(folder / "l.gz", std::filesystem::file_size(folder / "l.gz") - 100);
  const ReadLog log = read_all(folder / "l.gz");
  EXPECT_GT(log.entries.size(), 2000U);
  EXPECT_LT(log.entries.size(), 3000U);
  ASSERT_GE(log.damages.size(), 1U);
  EXPECT_EQ(log.damages.back().kind, "broken data");
}

TEST(Log, AFileThatMayNotBeReadIsTheSystemsNo) {
  const test::TempFolder folder;
  std::filesystem::permissions(folder.put("l", "x"), std::filesystem::perms::none);
  const auto open = [&] { open_log(folder / "l"); };
  if (::geteuid() != 0) {
    EXPECT_THROW(open(), SystemError);
  } else {  // who may read every file
    EXPECT_THAT(test::told_to_nobody(open), HasSubstr("ermission denied"));
  }
}

TEST(Log, RecordedCarmenLogsAreReadWhole) {
  const std::map<std::string, std::pair<std::size_t, std::size_t>> expected{
      {"intel-corrected.log.gz", {910, 180}},
      {"intel-raw.log.gz", {13631, 180}},
      {"freiburg-079-corrected.log.gz", {4791, 360}},
      {"fr079-raw.log.gz", {4934, 360}}};
  if (test::recorded_data("carmen").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const auto& [name, counts] : expected) {
    const ReadLog log = read_all(test::recorded_data("carmen/" + name));
    EXPECT_EQ(log.entries.size(), counts.first) << name;
    EXPECT_EQ(log.entries.back().scan.size(), counts.second) << name;
    EXPECT_TRUE(log.damages.empty()) << name << log.damages[0].text;
  }
}

}  // namespace
}  // namespace phasescan::log_test
