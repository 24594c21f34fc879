#include "calibrate/calibrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrate/stops_log.hpp"
#include "sim/pairs_spec.hpp"
#include "support/data.hpp"

namespace phasescan::calibrate_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

LogEntry entry_of(const std::vector<float>& raw, double stamp_s) {
  LogEntry entry;
  entry.scan = make_scan(raw, {0.0, kTwoPi / static_cast<double>(std::max<std::size_t>(2, raw.size())), 0.0, 0.0});
  entry.scan.stamp = stamp_from_seconds(stamp_s);
  entry.laser = "laser";
  entry.odometry = Pose2{};
  return entry;
}

TEST(Calibrate, LogsThatSayNothingGiveNothing) {
  EXPECT_FALSE(test::calibrate({}));
  const std::vector<std::vector<float>> kinds{{},
                                              {1.0F},
                                              std::vector<float>(360, 0.0F),
                                              std::vector<float>(360, kNaN),
                                              std::vector<float>(10, 2.0F),
                                              std::vector<float>(360, std::numeric_limits<float>::infinity())};
  for (const auto& raw : kinds) {
    std::vector<LogEntry> log;
    for (int k = 0; k < 40; ++k) log.push_back(entry_of(raw, 0.1 * k));
    EXPECT_FALSE(test::calibrate(log)) << raw.size();
  }
  EXPECT_FALSE(test::calibrate({entry_of(std::vector<float>(360, 2.0F), 0.0)}));
}

TEST(Calibrate, ARobotThatNeverStopsGivesNothing) {
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, 3);
  sim::PathOptions way;
  way.duration_s = 40.0;
  for (const bool odometry : {false, true}) {
    sim::DriveOptions what;
    what.odometry = odometry;
    sim::Drive drive(world, sim::read_lidar("ld06"), sim::Path(world, way, 1), what, 2);
    Calibrator calibrator;
    while (auto scan = drive.next()) {
      if (scan->entry.scan.stamp > stamp_from_seconds(2.0) && scan->entry.scan.stamp < stamp_from_seconds(36.0))
        calibrator.add(scan->entry);
    }
    EXPECT_FALSE(calibrator.finish()) << odometry;
  }
}

TEST(Calibrate, StrangeScansAmongGoodOnesDoNoHarm) {
  const sim::LidarOptions lidar = sim::read_lidar("rplidar-a1-real");
  const auto clean = test::stops_log(lidar);
  std::vector<LogEntry> dirty;
  Random random(9);
  for (const LogEntry& entry : clean) {
    dirty.push_back(entry);
    if (!random.chance(0.05)) continue;
    LogEntry odd = entry;
    const auto kind = random.below(4);
    std::vector<float> raw(kind == 3 ? 90 : 360, kind == 0 ? 0.0F : kind == 1 ? kNaN : 1e30F);
    if (kind == 3) {
      for (float& r : raw) r = static_cast<float>(random.uniform(0.2, 5.0));
    }
    odd.scan = make_scan(raw, {0.0, -kTwoPi / static_cast<double>(raw.size()), 0.0, 6.0});
    dirty.push_back(odd);
  }
  const auto a = test::calibrate(clean), b = test::calibrate(dirty);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(b->noise.jitter_variance, a->noise.jitter_variance, 0.01);
  EXPECT_NEAR(b->sensor.effects.revolution_turn_deg, a->sensor.effects.revolution_turn_deg, 0.01);
  EXPECT_EQ(b->sensor.beams, 360);
}

TEST(Calibrate, NothingOfTheAnswerIsOutOfItsBounds) {
  // Random rubbish that stands still: whatever is fitted must be a sensor that the simulator takes.
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const auto beams = static_cast<std::size_t>(40 + random.below(400));
    std::vector<float> base(beams);
    for (std::size_t i = 0; i < beams; ++i)
      base[i] = static_cast<float>(2.0 + std::sin(0.1 * static_cast<double>(i)) * random.uniform(0.9, 1.0));
    std::vector<LogEntry> log;
    for (int k = 0; k < 60; ++k) {
      auto raw = base;
      for (float& r : raw)
        r = random.chance(0.3 * random.uniform()) ? kNaN : r + static_cast<float>(random.normal(0.0, 0.01));
      log.push_back(entry_of(raw, seed % 3 == 0 ? 0.0 : 0.1 * k - (k % 7 == 0 ? 0.3 : 0.0)));
    }
    const auto got = test::calibrate(log);
    if (!got) continue;
    EXPECT_NO_THROW(sim::check_lidar("sensor", got->sensor)) << seed;
    EXPECT_NO_THROW(sim::parse_lidar(format_sensor_file(*got, "x"), "s.yaml")) << format_sensor_file(*got, "x");
    EXPECT_FALSE(format_calibration(*got).empty());
  }
}

TEST(Calibrate, ScansWithoutABeamCountOfTheirOwnAreReadByBearing) {
  // A sensor whose scans have 340 to 380 beams, as drivers that do not bin them hand over.
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, 2);
  const sim::RayCaster caster(world.shape);
  std::vector<LogEntry> log;
  Random place(1), size(2);
  Pose2 pose;
  for (int k = 0; k < 400; ++k) {
    if (k % 20 == 0) pose = *sim::draw_pose(world, caster, 0.3, place);
    sim::LidarOptions lidar = test::plain_lidar();
    lidar.beams = static_cast<int>(350 + size.below(21));
    Random random(Random::derive(3, static_cast<std::uint64_t>(k)));
    LogEntry entry;
    entry.scan = sim::simulate_scan({&caster, nullptr}, lidar, pose, random);
    entry.scan.stamp = stamp_from_seconds(0.18 * k);
    entry.odometry = pose;
    log.push_back(entry);
  }
  const auto got = test::calibrate(log);
  ASSERT_TRUE(got);
  EXPECT_GE(got->sensor.beams, 350);
  EXPECT_LE(got->sensor.beams, 370);
  EXPECT_EQ(got->stops, 20U);
}

TEST(Calibrate, OtherLasersAreLeftOutAndCounted) {
  auto log = test::stops_log(sim::read_lidar("ld06"), {.stops = 5});
  Calibrator calibrator;
  for (LogEntry entry : log) {
    calibrator.add(entry);
    entry.laser = "rear";
    calibrator.add(entry);
  }
  EXPECT_EQ(calibrator.scans(), log.size());
  EXPECT_EQ(calibrator.of_other_lasers(), log.size());
  EXPECT_TRUE(calibrator.finish());
}

TEST(Grains, OfRangesAndDirections) {
  std::vector<float> ranges;
  for (int i = 200; i < 3000; i += 7) ranges.push_back(static_cast<float>(0.002 * i));
  EXPECT_EQ(range_grain(ranges), 0.002);
  Random random(1);
  for (float& range : ranges) range += static_cast<float>(random.uniform(0.0, 0.001));
  EXPECT_EQ(range_grain(ranges), 0.0);
  EXPECT_EQ(range_grain({}), 0.0);
  EXPECT_EQ(bearing_grain_deg({}), 0.0);
  EXPECT_EQ(bearing_grain_deg({0.0F, 0.1F, 0.2F, 0.3F}), 0.0);  // evenly spaced: nothing is rounded
}

TEST(Memory, IsInvertedForShortStops) {
  // The share that short runs of a chain show, against the chain's own memory.
  for (const double memory : {0.0, 0.3, 0.6, 0.8}) {
    for (const int scans : {8, 15, 30}) {
      Random random(7);
      double more = 0.0, most = 0.0;
      for (int run = 0; run < 60'000 / scans; ++run) {
        double lost = 0.0, both = 0.0;
        bool before = false;
        double luck = random.uniform();
        for (int k = 0; k < scans; ++k) {
          if (k > 0 && !random.chance(memory)) luck = random.uniform();
          const bool now = luck < 0.3;
          lost += now;
          both += k > 0 && now && before;
          before = now;
        }
        more += both - lost * (lost - 1.0) / scans;
        most += lost * (scans - lost) / scans;
      }
      EXPECT_NEAR(memory_from_share(more / most, scans), memory, 0.03) << scans;
    }
  }
}

/// The row of the table that begins at a range.
const StandstillRow* row_from(const StandstillTable& table, double from) {
  for (const StandstillRow& row : table.rows) {
    if (row.from == from) return &row;
  }
  return nullptr;
}

/// Recorded on rplidar-a1-16m (docs/simulator.md): range from, median and steep spread [mm].
struct RecordedRow {
  double from, median, steep;
};
constexpr RecordedRow kRecordedA1[] = {{0.2, 1.1, 6.5},  {0.5, 2.3, 7.4}, {1.0, 3.7, 8.7}, {1.5, 4.7, 10.6},
                                       {2.0, 6.3, 10.8}, {3.0, 10.9, 15}, {4.0, 17, 20.4}};

TEST(StandstillTable, TheSimulatedA1LooksLikeTheRecordedOne) {
  // Rooms differ in how many beams of a row meet walls at an angle: three buildings, as one recording has many places.
  std::vector<LogEntry> log;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto more = test::stops_log(sim::read_lidar("rplidar-a1-lossy"), {.stops = 25, .scans = 16, .seed = seed});
    log.insert(log.end(), more.begin(), more.end());
  }
  const auto got = test::calibrate(log);
  ASSERT_TRUE(got);
  for (const RecordedRow& recorded : kRecordedA1) {
    const StandstillRow* row = row_from(got->table, recorded.from);
    ASSERT_TRUE(row) << recorded.from;
    EXPECT_NEAR(1000.0 * row->median, recorded.median, 0.25 * recorded.median) << recorded.from;
    EXPECT_NEAR(1000.0 * row->steep, recorded.steep, 0.25 * recorded.steep) << recorded.from;
  }
  EXPECT_NEAR(got->table.turn_steps, 0.118, 0.02);
  EXPECT_NEAR(got->table.present, 0.85, 0.05);
  EXPECT_NEAR(got->table.come_and_go, 0.63, 0.1);
}

TEST(StandstillTable, TheOldA1DoesNot) {
  const auto got = test::calibrate(test::stops_log(sim::read_lidar("rplidar-a1"), {.stops = 12}));
  ASSERT_TRUE(got);
  EXPECT_GT(row_from(got->table, 0.5)->median, 0.008);
  EXPECT_GT(got->table.present, 0.95);
  EXPECT_LT(got->sensor.effects.revolution_turn_deg, 0.02);
}

TEST(StandstillTable, ByHand) {
  // Ten scans of a round room: even beams alternate by 1 cm, odd ones by 2 mm; one beam in ten answers half the time.
  Stop stop;
  stop.beams = 360;
  stop.step = kTwoPi / 360.0;
  stop.closed = true;
  for (int k = 0; k < 10; ++k) {
    std::vector<float> ranges(360);
    for (int i = 0; i < 360; ++i) {
      const double off = (k % 2 == 0 ? 1.0 : -1.0) * (i % 2 == 0 ? 0.01 : 0.002);
      ranges[static_cast<std::size_t>(i)] = i % 10 == 0 && k < 5 ? kNaN : static_cast<float>(2.5 + off);
    }
    stop.ranges.push_back(ranges);
  }
  const std::vector<StopBeams> stops{summarise(stop)};
  const StandstillTable table = standstill_table(stops);
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].from, 2.0);
  EXPECT_EQ(table.rows[0].beams, 324U);
  EXPECT_NEAR(table.rows[0].median, 0.002, 1e-6);  // 180 odd beams of 324
  EXPECT_NEAR(table.rows[0].most, 0.01, 1e-6);
  EXPECT_TRUE(std::isnan(table.rows[0].steep));
  EXPECT_NEAR(table.present, (324.0 + 36.0 * 0.5) / 360.0, 1e-9);
  EXPECT_NEAR(table.come_and_go, 0.1, 1e-9);
}

TEST(RecordedStandstill, IsWhatTheSensorFileSays) {
  const std::string path = test::recorded_data("lowcost/rplidar-a1-16m.log.gz");
  if (path.empty()) GTEST_SKIP() << "no recorded data";
  const auto reader = open_log(path);
  Calibrator calibrator;
  while (const auto entry = reader->next()) calibrator.add(*entry);
  const auto got = calibrator.finish();
  ASSERT_TRUE(got);
  EXPECT_GT(got->stops, 100U);
  for (const RecordedRow& recorded : kRecordedA1) {
    const StandstillRow* row = row_from(got->table, recorded.from);
    ASSERT_TRUE(row) << recorded.from;
    EXPECT_NEAR(1000.0 * row->median, recorded.median, 0.1 * recorded.median);
  }
  const sim::LidarOptions file = sim::read_lidar("rplidar-a1-real");
  EXPECT_NEAR(got->sensor.effects.revolution_turn_deg, file.effects.revolution_turn_deg, 0.01);
  EXPECT_NEAR(got->sensor.effects.sample_rate_hz, file.effects.sample_rate_hz, 20.0);
  EXPECT_EQ(got->sensor.resolution_m, file.resolution_m);
}

TEST(RecordedStandstill, AnotherRecordingOfTheA1Agrees) {
  // Chosen on the other one; here are two stops with 35 scans.
  const std::string path = test::recorded_data("lowcost/rplidar-a1-14m.log.gz");
  if (path.empty()) GTEST_SKIP() << "no recorded data";
  const auto reader = open_log(path);
  Calibrator calibrator;
  while (const auto entry = reader->next()) calibrator.add(*entry);
  const auto got = calibrator.finish();
  ASSERT_TRUE(got);
  const sim::LidarOptions file = sim::read_lidar("rplidar-a1-real");
  EXPECT_NEAR(std::sqrt(got->noise.jitter_variance), 1.0 / std::sqrt(12.0), 0.06);
  EXPECT_NEAR(got->sensor.effects.revolution_turn_deg, file.effects.revolution_turn_deg, 0.04);
  EXPECT_NEAR(got->sensor.effects.sample_rate_hz, file.effects.sample_rate_hz, 40.0);
}

}  // namespace
}  // namespace phasescan::calibrate_test
