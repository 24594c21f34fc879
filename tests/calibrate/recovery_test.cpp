// What is simulated is measured again: each effect, on several sensors and seeds, on and off.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/stops_log.hpp"
#include "sim/pairs_spec.hpp"

namespace phasescan::recovery_test {
namespace {

using test::calibrate;
using test::plain_lidar;
using test::stops_log;
using test::StopsLog;

/// Linear between the entries of a measured table.
double at(const sim::Table& ranges, const sim::Table& values, double range) {
  return sim::table_value(ranges, values, range);
}

TEST(Recovery, RangeNoiseByRange) {
  for (const char* name : {"rplidar-a1", "ld06", "urg-04lx", "rplidar-a1-real"}) {
    for (const std::uint64_t seed : {1, 2}) {
      const sim::LidarOptions lidar = sim::read_lidar(name);
      const auto got = calibrate(stops_log(lidar, {.seed = seed}));
      ASSERT_TRUE(got) << name;
      const auto& effects = got->sensor.effects;
      ASSERT_GE(effects.noise_ranges_m.size(), 4U);
      for (const double range : {0.7, 1.0, 1.5, 2.0, 3.0}) {
        const double truth = lidar.sigma(range), seen = at(effects.noise_ranges_m, effects.noise_sigmas_m, range);
        EXPECT_NEAR(seen, truth, 0.25 * truth + 0.0003) << name << " seed " << seed << " at " << range;
      }
    }
  }
}

TEST(Recovery, JitterOfBeams) {
  for (const double jitter_deg : {0.0, 0.1, 0.3}) {
    for (const std::uint64_t seed : {1, 2}) {
      sim::LidarOptions lidar = plain_lidar();
      lidar.effects.direction_jitter_deg = jitter_deg;
      const auto got = calibrate(stops_log(lidar, {.seed = seed}));
      ASSERT_TRUE(got);
      EXPECT_NEAR(got->sensor.effects.direction_jitter_deg, jitter_deg, 0.1 * jitter_deg + 0.02) << seed;
      EXPECT_EQ(got->sensor.effects.sample_rate_hz, 0.0) << "jitter is no sampling";
      EXPECT_LT(got->sensor.effects.revolution_turn_deg, 0.025) << jitter_deg;
    }
  }
}

TEST(Recovery, TurnOfRevolutions) {
  for (const double turn_deg : {0.0, 0.06, 0.2}) {
    for (const std::uint64_t seed : {1, 2}) {
      sim::LidarOptions lidar = plain_lidar();
      lidar.effects.revolution_turn_deg = turn_deg;
      lidar.effects.direction_jitter_deg = 0.1;
      const auto got = calibrate(stops_log(lidar, {.seed = seed}));
      ASSERT_TRUE(got);
      EXPECT_NEAR(got->sensor.effects.revolution_turn_deg, turn_deg, 0.15 * turn_deg + 0.015) << seed;
      EXPECT_NEAR(got->sensor.effects.direction_jitter_deg, 0.1, 0.025) << turn_deg;
    }
  }
}

TEST(Recovery, SamplesOutOfStep) {
  for (const double samples : {330.0, 345.0}) {
    sim::LidarOptions lidar = plain_lidar();
    lidar.effects.sample_rate_hz = samples * lidar.rate_hz;
    lidar.effects.rate_wander = 0.002;
    const auto got = calibrate(stops_log(lidar));
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->sensor.effects.sample_rate_hz / got->sensor.rate_hz, samples, 5.0);
    EXPECT_EQ(got->sensor.effects.direction_jitter_deg, 0.0);
    EXPECT_NEAR(std::sqrt(got->noise.jitter_variance), 1.0 / std::sqrt(12.0), 0.03);
  }
}

TEST(Recovery, DropoutByRangeAndItsMemory) {
  for (const double memory : {0.0, 0.5}) {
    for (const std::uint64_t seed : {1, 2}) {
      sim::LidarOptions lidar = plain_lidar();
      lidar.effects.dropout_ranges_m = {0.5, 4.0};
      lidar.effects.dropout_shares = {0.05, 0.4};
      lidar.effects.dropout_memory = memory;
      const auto got = calibrate(stops_log(lidar, {.stops = 30, .scans = 25, .seed = seed}));
      ASSERT_TRUE(got);
      const auto& effects = got->sensor.effects;
      EXPECT_NEAR(effects.dropout_memory, memory, 0.06) << seed;
      for (const double range : {0.8, 1.5, 3.0}) {
        EXPECT_NEAR(at(effects.dropout_ranges_m, effects.dropout_shares, range), 0.05 + 0.1 * (range - 0.5), 0.04)
            << range << " memory " << memory << " seed " << seed;
      }
    }
  }
}

TEST(Recovery, SurfaceThatAnswersBadly) {
  for (const double share : {0.0, 0.1, 0.25}) {
    sim::LidarOptions lidar = plain_lidar();
    lidar.effects.patch_share = share;
    lidar.effects.patch_m = 0.4;
    const auto got = calibrate(stops_log(lidar, {.stops = 40}));
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->sensor.effects.patch_share, share, 0.3 * share + 0.01);
    EXPECT_LT(at(got->sensor.effects.dropout_ranges_m, got->sensor.effects.dropout_shares, 1.5), 0.01);
  }
}

TEST(Recovery, EdgesThatAnswerNothing) {
  for (const double loss : {0.0, 0.3, 0.6}) {
    sim::LidarOptions lidar = plain_lidar();
    lidar.effects.edge_loss = loss;
    lidar.effects.edge_width_deg = 2.0;
    const auto got = calibrate(stops_log(lidar, {.stops = 40}));
    ASSERT_TRUE(got);
    EXPECT_GT(got->edges.edges, 100U);
    EXPECT_NEAR(got->sensor.effects.edge_loss, loss, 0.25 * loss + 0.01);
    if (loss > 0.0) {
      EXPECT_NEAR(got->sensor.effects.edge_width_deg, 2.0, 0.5);
    }
  }
}

TEST(Recovery, MixedPixels) {
  for (const double mixed : {0.0, 0.3, 0.8}) {
    sim::LidarOptions lidar = plain_lidar();
    lidar.mixed_pixels = mixed;
    const auto got = calibrate(stops_log(lidar, {.stops = 40}));
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->sensor.mixed_pixels, mixed, 0.35 * mixed + 0.02);
  }
}

TEST(Recovery, LostSectorsAndRevolutions) {
  for (const std::uint64_t seed : {1, 2}) {
    sim::LidarOptions lidar = sim::read_lidar("rplidar-a1-lossy");
    const auto got = calibrate(stops_log(lidar, {.stops = 50, .seed = seed}));
    ASSERT_TRUE(got);
    const auto& effects = got->sensor.effects;
    EXPECT_NEAR(effects.lost_sectors, 0.137, 0.035);
    EXPECT_NEAR(effects.lost_sector_min_deg, 30.0, 12.0);
    EXPECT_NEAR(effects.lost_sector_max_deg, 120.0, 12.0);
    EXPECT_NEAR(effects.lost_revolutions, 0.12, 0.035);
    EXPECT_EQ(effects.lost_burst_min, 1);
    EXPECT_EQ(effects.lost_burst_max, 8);
    const auto none = calibrate(stops_log(plain_lidar(), {.seed = seed}));
    EXPECT_EQ(none->sensor.effects.lost_sectors, 0.0);
    EXPECT_EQ(none->sensor.effects.lost_revolutions, 0.0);
  }
}

TEST(Recovery, RateAndItsWander) {
  for (const double seconds : {0.0, 4.0}) {
    sim::LidarOptions lidar = plain_lidar();
    lidar.rate_hz = 7.3;
    lidar.effects.rate_wander = 0.015;
    lidar.effects.rate_wander_s = seconds;
    std::vector<Stamp> stamps;
    for (const auto& time : sim::plan_revolutions(lidar, 1500.0, 3)) stamps.push_back(stamp_from_seconds(time.start_s));
    const TimingFit got = fit_timing(stamps);
    EXPECT_NEAR(got.rate_hz, 7.3, 0.02);
    EXPECT_NEAR(got.wander, 0.015, 0.002);
    EXPECT_NEAR(got.wander_s, seconds, 0.3 * seconds + 0.01);
    EXPECT_EQ(got.burst_max, 0);
  }
}

TEST(Recovery, LateStampsAreNoWander) {
  Random random(4);
  std::vector<Stamp> stamps;
  for (int k = 0; k < 4000; ++k) stamps.push_back(stamp_from_seconds(0.1 * k + random.uniform(0.0, 0.01)));
  const TimingFit got = fit_timing(stamps);
  EXPECT_NEAR(got.rate_hz, 10.0, 0.001);
  EXPECT_LT(got.wander, 0.012);  // the stamps alone scatter by 4 % of the period
}

TEST(Recovery, GeometryAndGrains) {
  for (const char* name : {"urg-04lx", "ydlidar-x4", "rplidar-c1", "hall-30m"}) {
    sim::LidarOptions lidar = sim::read_lidar(name);
    const auto got = calibrate(stops_log(lidar, {.stops = 6}));
    ASSERT_TRUE(got) << name;
    EXPECT_EQ(got->sensor.beams, lidar.beams);
    EXPECT_NEAR(got->sensor.fov_deg, lidar.fov_deg, 1e-4);
    EXPECT_NEAR(std::remainder(got->sensor.angle_min_deg - lidar.angle_min_deg, 360.0), 0.0, 1e-4);
    EXPECT_EQ(got->sensor.clockwise, lidar.clockwise);
    EXPECT_EQ(got->sensor.range_min_m, lidar.range_min_m);
    EXPECT_EQ(got->sensor.range_max_m, lidar.range_max_m);
    EXPECT_EQ(got->sensor.resolution_m, lidar.resolution_m) << name;
    EXPECT_NEAR(got->sensor.rate_hz, lidar.rate_hz, 0.01);
  }
  sim::LidarOptions lidar = sim::read_lidar("ld06");
  lidar.effects.bearing_step_deg = 0.25;
  EXPECT_EQ(calibrate(stops_log(lidar, {.stops = 6}))->sensor.effects.bearing_step_deg, 0.25);
}

TEST(Recovery, StopsAreFoundWithoutWheelsToo) {
  const sim::LidarOptions lidar = sim::read_lidar("rplidar-a1-real");
  const auto with = calibrate(stops_log(lidar)), without = calibrate(stops_log(lidar, {.wheels = false}));
  ASSERT_TRUE(with && without);
  EXPECT_TRUE(with->by_wheels);
  EXPECT_FALSE(without->by_wheels);
  EXPECT_NEAR(static_cast<double>(with->stops), 25.0, 1.0);
  EXPECT_GE(without->stops, 24U);
  EXPECT_NEAR(without->sensor.effects.revolution_turn_deg, with->sensor.effects.revolution_turn_deg, 0.015);
  EXPECT_NEAR(without->noise.jitter_variance, with->noise.jitter_variance, 0.01);
}

TEST(Recovery, WhatIsMeasuredReadsBackAsItWas) {
  const auto got = calibrate(stops_log(sim::read_lidar("rplidar-a1-lossy"), {.stops = 50}));
  ASSERT_TRUE(got);
  const std::string text = format_sensor_file(*got, "a log\nwith: a name");
  const sim::LidarOptions read = sim::parse_lidar(text, "s.yaml");
  std::vector<std::string> values[2];
  for (const int k : {0, 1}) {
    const sim::LidarOptions& lidar = k == 0 ? got->sensor : read;
    sim::LidarOptions::visit(lidar, [&](std::string_view name, const auto& value, const OptionInfo&) {
      using T = std::decay_t<decltype(value)>;
      std::string out(name);
      if constexpr (std::is_same_v<T, sim::Table>) {
        for (const double v : value) out += " " + std::to_string(v);
      } else if constexpr (std::is_enum_v<T>) {
        out += std::string(to_string(value));
      } else {
        out += std::to_string(value);
      }
      values[k].push_back(out);
    });
  }
  EXPECT_EQ(values[0], values[1]) << text;
}

}  // namespace
}  // namespace phasescan::recovery_test
