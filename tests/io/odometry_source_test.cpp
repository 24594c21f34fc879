#include "io/odometry_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp.hpp"

namespace phasescan::odometry_source_test {
namespace {

using ::testing::HasSubstr;

/// A log made of entries, which counts how many were asked for.
class MadeLog : public LogReader {
 public:
  std::optional<LogEntry> next() override {
    if (given == entries.size()) return std::nullopt;
    return entries[given++];
  }
  std::string format() const override { return "made"; }
  std::map<std::string, std::string> facts() const override {
    if (given < marks_from) return {};
    return {{"lines NEFF", "3"}};
  }

  /// A scan whose corrected pose is `off_m` away from its odometry.
  void add(double x, std::optional<double> off_m, bool odometry = true) {
    LogEntry entry;
    entry.T_base_laser = {0.2, 0.0, 0.0};
    if (odometry) entry.odometry = Pose2{x, 0.0, 0.1};
    if (off_m) entry.corrected = Pose2{x + *off_m, 0.0, 0.1} * entry.T_base_laser;
    entries.push_back(entry);
  }

  std::vector<LogEntry> entries;
  std::size_t given = 0, marks_from = 1'000'000;
};

struct Told {
  std::size_t scans = 0, with_odometry = 0;
  OdometrySource source;
};

Told read_judged(LogReader& log) {
  JudgedLog judged(log);
  Told told;
  while (const auto entry = judged.next()) {
    ++told.scans;
    told.with_odometry += entry->odometry.has_value();
  }
  told.source = judged.source();
  return told;
}

MadeLog same_poses(std::size_t scans, std::size_t marks_from = 1'000'000) {
  MadeLog log;
  for (std::size_t k = 0; k < scans; ++k) log.add(0.1 * static_cast<double>(k), 0.0);
  log.marks_from = marks_from;
  return log;
}

TEST(JudgedLog, SamePosesWithMarksOfAMappingProgramAreNoOdometry) {
  for (const std::size_t scans : {1, 20, 50, 51, 300}) {
    MadeLog log = same_poses(scans, 1);
    const Told told = read_judged(log);
    EXPECT_EQ(told.scans, scans);
    EXPECT_EQ(told.with_odometry, 0U) << scans;
    EXPECT_FALSE(told.source.usable);
    EXPECT_THAT(told.source.assumed, HasSubstr("a mapping program has left its marks: counted as no odometry"));
  }
}

TEST(JudgedLog, SamePosesWithoutMarksAreOdometryWrittenTwice) {
  for (const std::size_t scans : {1, 20, 50, 51, 300}) {
    MadeLog log = same_poses(scans);
    const Told told = read_judged(log);
    EXPECT_EQ(told.with_odometry, scans);
    EXPECT_THAT(told.source.assumed, HasSubstr("no mark of a mapping program: taken as odometry"));
  }
}

TEST(JudgedLog, OdometryThatDiffersOrStandsAloneIsUsed) {
  MadeLog differs, alone, none;
  for (int k = 0; k < 100; ++k) {
    differs.add(0.1 * k, 0.01 * k);
    alone.add(0.1 * k, std::nullopt);
    none.add(0.1 * k, std::nullopt, false);
  }
  differs.marks_from = alone.marks_from = 0;
  for (MadeLog* log : {&differs, &alone}) {
    const Told told = read_judged(*log);
    EXPECT_EQ(told.with_odometry, 100U);
    EXPECT_TRUE(told.source.usable);
    EXPECT_EQ(told.source.assumed, "the log's odometry is used");
  }
  const Told told = read_judged(none);
  EXPECT_EQ(told.scans, 100U);
  EXPECT_FALSE(told.source.usable);
  EXPECT_EQ(told.source.assumed, "the log holds no odometry");
}

TEST(JudgedLog, OdometryMayBeginLate) {
  MadeLog log;
  for (int k = 0; k < 200; ++k) log.add(0.1 * k, std::nullopt, k >= 150);
  const Told told = read_judged(log);
  EXPECT_EQ(told.with_odometry, 50U);
  EXPECT_TRUE(told.source.usable);
}

TEST(JudgedLog, WhatIsDecidedStaysAndWhatTheLogShowsLaterIsSaid) {
  MadeLog later = same_poses(80, 1);
  for (int k = 0; k < 20; ++k) later.add(k, 1.0);
  Told told = read_judged(later);
  EXPECT_EQ(told.with_odometry, 0U);
  EXPECT_THAT(told.source.assumed, HasSubstr("the same up to scan 80 (which decided) and a mapping"));
  MadeLog marked_late = same_poses(80, 70);
  told = read_judged(marked_late);
  EXPECT_EQ(told.with_odometry, 80U);
  EXPECT_THAT(told.source.assumed, HasSubstr("marks came later"));
}

TEST(JudgedLog, HoldsBackNoMoreThanItMust) {
  MadeLog alone, same = same_poses(300), differs;
  for (int k = 0; k < 100; ++k) alone.add(k, std::nullopt);
  for (int k = 0; k < 100; ++k) differs.add(k, 1.0);
  for (auto [log, most] : {std::pair{&alone, 1U}, std::pair{&differs, 1U}, std::pair{&same, 50U}}) {
    JudgedLog judged(*log);
    static_cast<void>(judged.next());
    EXPECT_EQ(log->given, most);
  }
  // Scans that cannot decide, after one that waits: bounded all the same.
  MadeLog mixed;
  mixed.add(0.0, 0.0);
  for (int k = 0; k < 2000; ++k) mixed.add(k, std::nullopt);
  JudgedLog judged(mixed);
  static_cast<void>(judged.next());
  EXPECT_LE(mixed.given, 500U);
}

/// Scans every 0.1 s at x = t, every `n`-th with odometry.
MadeLog every_nth(std::size_t scans, std::size_t n) {
  MadeLog log;
  for (std::size_t k = 0; k < scans; ++k) {
    log.add(0.1 * static_cast<double>(k), std::nullopt, k % n == 0);
    log.entries.back().scan.stamp = static_cast<Stamp>(k) * 100'000'000;
  }
  return log;
}

TEST(InterpolatedOdometry, ScansBetweenTwoWithOdometryGetWhatLiesBetween) {
  MadeLog log = every_nth(30, 4);  // the last with odometry is 28
  JudgedLog judged(log, true);
  std::size_t k = 0;
  while (const auto entry = judged.next()) {
    ASSERT_EQ(entry->odometry.has_value(), k <= 28) << k;
    if (entry->odometry) {
      EXPECT_NEAR(entry->odometry->x, 0.1 * static_cast<double>(k), 1e-9);
    }
    ++k;
  }
  EXPECT_EQ(k, 30U) << "in order, none lost";
}

TEST(InterpolatedOdometry, NothingIsMadeUpOverMoreThanASecond) {
  MadeLog log = every_nth(40, 15);
  JudgedLog judged(log, true);
  std::size_t with = 0;
  while (const auto entry = judged.next()) with += entry->odometry.has_value();
  EXPECT_EQ(with, 3U);
}

TEST(InterpolatedOdometry, AScanWaitsNoLongerThanItsOdometryMayCome) {
  MadeLog log = every_nth(200, 1000);  // the first alone
  JudgedLog judged(log, true);
  for (int k = 0; k < 20; ++k) judged.next();
  EXPECT_LE(log.given, 20U + 11U);
  for (LogEntry& entry : log.entries) entry.scan.stamp = 0;  // without time it is their number
  log.given = 0;
  JudgedLog timeless(log, true);
  timeless.next();
  timeless.next();
  EXPECT_LE(log.given, 2U + OdometryQueue::kMostWaiting);
}

}  // namespace
}  // namespace phasescan::odometry_source_test
