// What is written reads back the same: every writable format, and every pair of them one after the other.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "io/cut_log.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/io/log.hpp"
#include "support/read_text.hpp"

namespace phasescan::round_trip_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Scans with every kind of missing beam and odd intensities; by `seed` with limits or without, clockwise or not.
std::vector<LogEntry> made_log(unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const bool limits = seed % 2 == 0, intensities = seed % 3 != 0, odometry = seed % 4 != 3;
  const ScanGeometry geometry{pick(-3.0, -1.0), (seed % 5 == 0 ? -1.0 : 1.0) * std::ldexp(1.0, -7),
                              limits ? 0.125 : 0.0, limits ? 16.0 : 0.0};
  std::vector<LogEntry> log;
  for (int k = 0; k < 12; ++k) {
    std::vector<float> raw(200);
    for (float& range : raw) range = static_cast<float>(pick(0.2, 15.0));
    raw[1] = 0.0F, raw[2] = kNan, raw[3] = kInf, raw[4] = -kInf, raw[5] = -1.0F, raw[6] = 0.0625F, raw[7] = 40.0F;
    LogEntry entry;
    entry.scan = make_scan(raw, geometry);
    entry.scan.stamp = 1'700'000'000'000'000'000 + k * 100'000'000LL;
    if (intensities) {
      for (std::size_t i = 0; i < raw.size(); ++i)
        entry.scan.intensities.push_back(static_cast<float>(pick(0.0, 255.0)));
      entry.scan.intensities[0] = kNan;
      entry.scan.intensities[1] = kInf;
    }
    if (odometry) entry.odometry = Pose2{pick(-5.0, 5.0), pick(-5.0, 5.0), pick(-3.0, 3.0)};
    entry.laser = "/scan";
    log.push_back(entry);
  }
  return log;
}

std::vector<LogEntry> written_and_read(const std::vector<LogEntry>& log, const std::string& path) {
  const auto writer = make_log_writer(log_target_for(path), path);
  for (const LogEntry& entry : log) writer->add(entry);
  writer->finish();
  test::ReadText read = test::read_log(path);
  EXPECT_TRUE(read.damages.empty()) << path << ": " << (read.damages.empty() ? "" : read.damages[0].text);
  return read.entries;
}

void expect_same(const std::vector<LogEntry>& got, const std::vector<LogEntry>& expected, const std::string& what) {
  ASSERT_EQ(got.size(), expected.size()) << what;
  for (std::size_t k = 0; k < got.size(); ++k) {
    const Scan &a = got[k].scan, &b = expected[k].scan;
    ASSERT_EQ(a.size(), b.size()) << what;
    EXPECT_LE(std::abs(a.stamp - b.stamp), 1000) << what;
    EXPECT_NEAR(a.geometry.angle_min, b.geometry.angle_min, 1e-6) << what;
    EXPECT_NEAR(a.geometry.angle_increment, b.geometry.angle_increment, 1e-8) << what;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a.is_hit(i), b.is_hit(i)) << what << " beam " << i;
      if (a.is_hit(i) && b.is_hit(i)) {
        EXPECT_EQ(a.ranges[i], b.ranges[i]) << what << " beam " << i;
      }
    }
    if (!a.intensities.empty()) {
      ASSERT_EQ(a.intensities.size(), b.intensities.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a.intensities[i], std::isfinite(b.intensities[i]) ? b.intensities[i] : 0.0F) << what << " beam " << i;
      }
    }
    EXPECT_EQ(got[k].odometry.has_value(), expected[k].odometry.has_value()) << what;
    if (!got[k].odometry || !expected[k].odometry) continue;
    EXPECT_NEAR(got[k].odometry->x, expected[k].odometry->x, 1e-9) << what;
    EXPECT_NEAR(angle_distance(got[k].odometry->theta, expected[k].odometry->theta), 0.0, 1e-9) << what;
  }
}

TEST(RoundTrip, EveryPairOfFormatsKeepsWhatBothCanSay) {
  const test::TempFolder folder;
  const std::string endings[] = {".jsonl", ".jsonl.gz", ".mcap", ".log", ".log.gz"};
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const std::vector<LogEntry> log = made_log(seed);
    for (const std::string& first : endings) {
      const std::vector<LogEntry> once = written_and_read(log, folder / ("a" + first));
      expect_same(once, log, first + " of " + std::to_string(seed));
      for (const std::string& second : endings)
        expect_same(written_and_read(once, folder / ("b" + second)), once, first + " to " + second);
    }
  }
}

TEST(RoundTrip, ReasonsOfMissingBeamsStayWhereTheLimitsAreKnown) {
  const test::TempFolder folder;
  const std::vector<LogEntry> log = made_log(2);
  for (const std::string ending : {".jsonl", ".mcap"}) {
    const auto back = written_and_read(log, folder / ("a" + ending));
    ASSERT_EQ(back.size(), log.size());
    for (std::size_t k = 0; k < log.size(); ++k) EXPECT_EQ(back[k].scan.states, log[k].scan.states) << ending;
  }
}

TEST(CutLog, RangesDirectionsAndTime) {
  LogOptions options;
  options.range_min = 1.0;
  options.range_max = 5.0;
  options.masks = {{deg_to_rad(170.0), deg_to_rad(-170.0)}, {deg_to_rad(10.0), deg_to_rad(20.0)}};
  Scan scan = make_scan(std::vector<float>(360, 2.0F), {0.0, deg_to_rad(1.0), 0.1, 12.0});
  scan.ranges[40] = 0.5F;
  scan.ranges[50] = 9.0F;
  const Scan cut = cut_scan(scan, options);
  EXPECT_EQ(cut.states[40], BeamState::kTooNear);
  EXPECT_EQ(cut.states[50], BeamState::kOutOfRange);
  EXPECT_EQ(cut.geometry.range_max, 5.0);
  EXPECT_EQ(cut.geometry.range_min, 1.0);
  EXPECT_EQ(360U - cut.hit_count(), 2U + 11U + 21U) << "both ends of a sector belong to it";
  EXPECT_EQ(cut.states[180], BeamState::kInvalid);
  EXPECT_EQ(cut.states[15], BeamState::kInvalid);
  EXPECT_EQ(cut.states[9], BeamState::kHit);

  const test::TempFolder folder;
  const std::string path = folder / "log.jsonl";
  written_and_read(made_log(1), path);
  const auto read = [&](std::optional<double> from, std::optional<double> to) {
    LogOptions cuts;
    cuts.from = from;
    cuts.to = to;
    return test::read_log(path, cuts).entries;
  };
  EXPECT_EQ(read(0.5, std::nullopt).size(), 7U);
  EXPECT_EQ(read(std::nullopt, 0.5).size(), 6U);
  EXPECT_EQ(read(0.25, 0.75).size(), 5U);
  EXPECT_EQ(read(0.25, 0.75).at(0).line, 4);
}

}  // namespace
}  // namespace phasescan::round_trip_test
