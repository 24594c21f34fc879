#include "sim/sensor_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "phasescan/io/error.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/revolution.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim::sensor_effects_test {
namespace {

/// A wall across the view: ranges change with the direction everywhere but straight ahead.
Shape long_wall(double away = 2.0) {
  Shape shape;
  shape.add_line({{away, -40.0}, {away, 40.0}});
  return shape;
}

/// No noise, losses or rounding, so that what is left is the effect under test.
LidarOptions clean_lidar() {
  LidarOptions lidar = LidarOptions{}.noise_free();
  lidar.clockwise = false;
  lidar.angle_min_deg = -180.0;
  return lidar;
}

/// Scans of a sensor that stands at the origin.
std::vector<Scan> standstill(const LidarOptions& lidar, const Shape& shape, int count, std::uint64_t seed = 1) {
  const RayCaster caster(shape);
  RevolutionSource source(lidar, seed);
  std::vector<Scan> scans;
  for (int k = 0; k < count; ++k) {
    Random random(Random::derive(seed, static_cast<std::uint64_t>(k)));
    scans.push_back(simulate_scan(
        {&caster, nullptr}, lidar, source, 1.0 / lidar.rate_hz, [](double) { return Pose2{}; }, 0.0, random));
  }
  return scans;
}

/// The direction in which a beam must have looked to see the wall at this range, on the beam's side.
double seen_direction(const Scan& scan, std::size_t i, double away = 2.0) {
  return std::copysign(std::acos(std::min(1.0, away / static_cast<double>(scan.ranges[i]))), scan.angle(i));
}

struct Moments {
  double sum = 0.0, sum2 = 0.0, n = 0.0;
  void add(double x) { sum += x, sum2 += x * x, n += 1.0; }
  double mean() const { return sum / n; }
  double sigma() const { return std::sqrt(sum2 / n - mean() * mean()); }
};

TEST(SensorEffects, RangeNoiseFollowsItsCurve) {
  LidarOptions lidar = clean_lidar();
  lidar.effects.noise_ranges_m = {1.0, 3.0};
  lidar.effects.noise_sigmas_m = {0.002, 0.02};
  EXPECT_DOUBLE_EQ(lidar.sigma(0.5), 0.002);
  EXPECT_DOUBLE_EQ(lidar.sigma(2.0), 0.011);
  EXPECT_DOUBLE_EQ(lidar.sigma(4.5), 0.03);
  for (const double away : {1.0, 2.0, 4.5}) {
    Moments off;
    for (const Scan& scan : standstill(lidar, long_wall(away), 4000)) off.add(scan.ranges[180] - away);
    EXPECT_NEAR(off.sigma(), lidar.sigma(away), 5.0 * lidar.sigma(away) / std::sqrt(2.0 * off.n)) << away;
  }
}

TEST(SensorEffects, JitterIsOfEachBeamAndTurnOfAll) {
  for (const bool turn : {false, true}) {
    LidarOptions lidar = clean_lidar();
    (turn ? lidar.effects.revolution_turn_deg : lidar.effects.direction_jitter_deg) = 0.2;
    Moments one, between;
    for (const Scan& scan : standstill(lidar, long_wall(), 3000)) {
      const double a = seen_direction(scan, 130) - scan.angle(130), b = seen_direction(scan, 230) - scan.angle(230);
      one.add(rad_to_deg(a));
      between.add(rad_to_deg(a - b));
    }
    EXPECT_NEAR(one.mean(), 0.0, 5.0 * 0.2 / std::sqrt(one.n));
    EXPECT_NEAR(one.sigma(), 0.2, 5.0 * 0.2 / std::sqrt(2.0 * one.n));
    EXPECT_NEAR(between.sigma(), turn ? 0.0 : 0.2 * std::sqrt(2.0), 0.02) << turn;
  }
}

TEST(SensorEffects, SamplesOutOfStepLeaveHolesAndErrorsOfHalfAStep) {
  LidarOptions lidar = clean_lidar();
  lidar.effects.sample_rate_hz = 340.37 * lidar.rate_hz;  // 340 samples for 360 beams, elsewhere in every turn
  Moments error;
  std::size_t silent = 0, asked = 0;
  double product = 0.0, square = 0.0;
  for (const Scan& scan : standstill(lidar, long_wall(), 300)) {
    double before = 0.0;
    for (std::size_t i = 120; i < 240; ++i, ++asked) {
      if (!scan.is_hit(i)) {
        ++silent;
        EXPECT_TRUE(scan.is_hit(i + 1)) << "two holes side by side";
        continue;
      }
      if (i > 170 && i < 190) continue;  // straight ahead the range does not tell the direction
      const double off = rad_to_deg(seen_direction(scan, i) - scan.angle(i));
      error.add(off);
      product += off * before;
      square += off * off;
      before = off;
    }
  }
  EXPECT_NEAR(static_cast<double>(silent) / static_cast<double>(asked), 20.0 / 360.0, 0.003);
  EXPECT_NEAR(error.sigma(), 1.0 / std::sqrt(12.0), 0.01);
  EXPECT_NEAR(error.mean(), 0.0, 0.01);
  EXPECT_GT(product / square, 0.6);  // it grows from beam to beam and jumps back
  EXPECT_NEAR(rad_to_deg(lidar.bearing_sigma()), 1.0 / std::sqrt(12.0), 1e-9);
}

TEST(SensorEffects, DropoutFollowsItsTableAndRemembers) {
  LidarOptions lidar = clean_lidar();
  lidar.effects.dropout_ranges_m = {1.0, 3.0};
  lidar.effects.dropout_shares = {0.1, 0.5};
  lidar.effects.dropout_memory = 0.7;
  const auto scans = standstill(lidar, long_wall(2.0), 6000);
  double lost = 0.0, both = 0.0;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    lost += scans[k].is_hit(180) ? 0.0 : 1.0;
    both += !scans[k].is_hit(180) && !scans[k - 1].is_hit(180) ? 1.0 : 0.0;
  }
  const double n = static_cast<double>(scans.size() - 1), share = lost / n;
  EXPECT_NEAR(share, 0.3, 0.05);  // the mean of 0.1 and 0.5; memory leaves fewer independent draws
  EXPECT_NEAR((both / n - share * share) / (share * (1.0 - share)), 0.7, 0.06);
}

TEST(SensorEffects, PatchesAnswerBadlyWhereTheyAre) {
  LidarOptions lidar = clean_lidar();
  lidar.effects.patch_share = 0.3;
  const auto scans = standstill(lidar, long_wall(), 200);
  std::size_t always = 0, partly = 0, beams = 0;
  for (std::size_t i = 130; i < 230; ++i, ++beams) {
    std::size_t hits = 0;
    for (const Scan& scan : scans) hits += scan.is_hit(i) ? 1 : 0;
    always += hits == scans.size();
    partly += hits > 10 && hits < 190;
  }
  EXPECT_NEAR(static_cast<double>(always) / static_cast<double>(beams), 0.7, 0.15);
  EXPECT_GT(partly, beams / 8);
  // The same patches for another sensor with other draws.
  const auto others = standstill(lidar, long_wall(), 200, 77);
  for (std::size_t i = 130; i < 230; ++i) {
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < scans.size(); ++k) a += scans[k].is_hit(i), b += others[k].is_hit(i);
    EXPECT_NEAR(a / 200.0, b / 200.0, 0.2) << i;
  }
}

TEST(SensorEffects, EdgesLoseBeamsOnBothSidesAndCornersNone) {
  Shape shape;
  shape.add_line({{1.0, 0.0}, {1.0, 2.0}});
  shape.add_line({{3.0, -3.0}, {3.0, 3.0}, {-3.0, 3.0}, {-3.0, -3.0}, {3.0, -3.0}});
  LidarOptions lidar = clean_lidar();
  lidar.angle_min_deg = -179.5;  // the edge straight ahead lies between two beams
  lidar.effects.edge_loss = 0.8;
  lidar.effects.edge_width_deg = 2.0;
  const auto scans = standstill(lidar, shape, 2000);
  const auto lost = [&](std::size_t i) {
    double count = 0.0;
    for (const Scan& scan : scans) count += scan.is_hit(i) ? 0.0 : 1.0;
    return count / static_cast<double>(scans.size());
  };
  for (const std::size_t i : {std::size_t{179}, std::size_t{180}}) EXPECT_NEAR(lost(i), 0.6, 0.06) << i;
  for (const std::size_t i : {std::size_t{178}, std::size_t{181}}) EXPECT_NEAR(lost(i), 0.2, 0.05) << i;
  EXPECT_EQ(lost(176), 0.0);
  EXPECT_EQ(lost(183), 0.0);
  for (std::size_t i = 30; i < 60; ++i) EXPECT_EQ(lost(i), 0.0) << "a corner is no edge: " << i;
}

TEST(SensorEffects, SectorsAreLostInThreeWays) {
  for (const SectorLoss kind : {SectorLoss::kEmpty, SectorLoss::kClosed, SectorLoss::kHeld}) {
    LidarOptions lidar = clean_lidar();
    lidar.effects.lost_sector_kind = kind;
    lidar.effects.lost_sector_min_deg = lidar.effects.lost_sector_max_deg = 60.0;
    Shape room;
    room.add_line({{2.0, -1.0}, {2.0, 3.0}, {-1.5, 3.0}, {-1.5, -1.0}, {2.0, -1.0}});
    const auto whole = standstill(lidar, room, 60);
    lidar.effects.lost_sectors = 0.25;
    const auto scans = standstill(lidar, room, 60);
    int hurt = 0;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      if (scans[k].ranges.size() == whole[k].ranges.size() && scans[k].hit_count() == 360 &&
          scans[k].ranges == whole[k].ranges)
        continue;
      ++hurt;
      std::size_t first = 0;
      while (scans[k].ranges[first] == whole[k].ranges[first]) ++first;
      if (kind == SectorLoss::kEmpty) {
        EXPECT_EQ(scans[k].hit_count(), 300U);
        for (std::size_t i = 0; i < 60; ++i) EXPECT_FALSE(scans[k].is_hit(first + i));
      } else {
        // What came later lies 60 beams too early; ranges repeat nowhere in this room but by chance.
        for (std::size_t i = first; i < 300; ++i) EXPECT_EQ(scans[k].ranges[i], whole[k].ranges[i + 60]);
        for (std::size_t i = 300; i < 360; ++i) {
          EXPECT_EQ(scans[k].is_hit(i), kind == SectorLoss::kHeld && k > 0);
          if (kind == SectorLoss::kHeld && k > 0) {
            EXPECT_EQ(scans[k].ranges[i], whole[k - 1].ranges[i]);
          }
        }
      }
    }
    EXPECT_GE(hurt, 7);
    EXPECT_LE(hurt, 24);
  }
}

TEST(SensorEffects, WrongStartAnglesTurnTheScanAndNothingElse) {
  LidarOptions lidar = clean_lidar();
  Shape room;
  room.add_line({{2.0, -1.0}, {2.0, 3.0}, {-1.5, 3.0}, {-1.5, -1.0}, {2.0, -1.0}});
  const auto right = standstill(lidar, room, 100);
  lidar.effects.wrong_start = 0.2;
  lidar.effects.wrong_start_min_deg = lidar.effects.wrong_start_max_deg = 90.0;
  const auto scans = standstill(lidar, room, 100);
  int turned = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const double same = std::abs(scans[k].ranges[10] - right[k].ranges[10]);
    if (same < 1e-5) continue;
    ++turned;
    const std::size_t shift = std::abs(scans[k].ranges[10] - right[k].ranges[100]) < 1e-4 ? 90 : 270;
    for (std::size_t i = 0; i < 360; ++i) EXPECT_NEAR(scans[k].ranges[i], right[k].ranges[(i + shift) % 360], 1e-4);
  }
  EXPECT_NEAR(turned, 20, 15);
}

TEST(SensorEffects, DirectionsAreStatedInGrains) {
  LidarOptions lidar = clean_lidar();
  lidar.beams = 450;
  lidar.effects.bearing_step_deg = 0.25;
  const auto scans = standstill(lidar, long_wall(), 1);
  ASSERT_EQ(scans[0].angles.size(), 450U);
  bool off = false;
  for (std::size_t i = 0; i < 450; ++i) {
    const double stated_deg = rad_to_deg(scans[0].angle(i)), true_deg = -180.0 + 0.8 * static_cast<double>(i);
    EXPECT_NEAR(stated_deg / 0.25, std::round(stated_deg / 0.25), 1e-3);
    EXPECT_LE(std::abs(stated_deg - true_deg), 0.125 + 1e-4);
    off = off || std::abs(stated_deg - true_deg) > 0.09;
  }
  EXPECT_TRUE(off);
}

TEST(SensorEffects, ATiltedSensorSeesTheFloorAndFartherWalls) {
  LidarOptions lidar = clean_lidar();
  lidar.range_max_m = 12.0;
  lidar.effects.tilt_deg = 3.0;
  lidar.effects.height_m = 0.25;
  const double floor = 0.25 / std::sin(deg_to_rad(3.0));  // 4.78 m ahead
  const auto near = standstill(lidar, long_wall(2.0), 1), far = standstill(lidar, long_wall(8.0), 1);
  EXPECT_NEAR(near[0].ranges[180], 2.0 / std::cos(deg_to_rad(3.0)), 1e-5);
  EXPECT_NEAR(far[0].ranges[180], floor, 1e-4);
  // A beam 40 degrees aside: direction and floor as a vector says.
  const double bearing = deg_to_rad(40.0), tilt = deg_to_rad(3.0);
  const double x = std::cos(bearing) * std::cos(tilt), z = std::cos(bearing) * std::sin(tilt);
  EXPECT_NEAR(near[0].ranges[220], 2.0 / x, 1e-4);
  EXPECT_NEAR(far[0].ranges[220], std::min(8.0 / x, 0.25 / z), 1e-4);
  lidar.effects.tilt_towards_deg = 180.0;  // up ahead: no floor there
  EXPECT_NEAR(standstill(lidar, long_wall(8.0), 1)[0].ranges[180], 8.0 / std::cos(tilt), 1e-4);
}

TEST(SensorEffects, TheRateWandersAboutItsMean) {
  LidarOptions lidar;
  lidar.effects.rate_wander = 0.02;
  lidar.effects.rate_wander_s = 3.0;
  const auto times = plan_revolutions(lidar, 2000.0, 5);
  Moments period;
  double product = 0.0;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    EXPECT_NEAR(times[k + 1].start_s, times[k].start_s + times[k].period_s, 1e-9);
    period.add(times[k].period_s * lidar.rate_hz - 1.0);
    product += (times[k].period_s * lidar.rate_hz - 1.0) * (times[k + 1].period_s * lidar.rate_hz - 1.0);
  }
  EXPECT_NEAR(period.mean(), 0.0, 0.005);
  EXPECT_NEAR(period.sigma(), 0.02, 0.003);
  EXPECT_NEAR(product / period.sum2, std::exp(-1.0 / 5.5 / 3.0), 0.03);
  EXPECT_LE(times.back().start_s + times.back().period_s, 2000.0 + 1e-6);
}

TEST(SensorEffects, RevolutionsAreLostInBurstsAndTheOthersStay) {
  const World world = make_world(WorldKind::kRoom, 4);
  PathOptions way;
  way.duration_s = 60.0;
  LidarOptions lidar;
  DriveOptions what;
  what.odometry = true;
  Drive whole(world, lidar, Path(world, way, 1), what, 2);
  lidar.effects.lost_revolutions = 0.1;
  lidar.effects.lost_burst_min = 2;
  lidar.effects.lost_burst_max = 4;
  Drive gappy(world, lidar, Path(world, way, 1), what, 2);
  std::map<Stamp, DriveScan> all;
  while (auto scan = whole.next()) all.emplace(scan->entry.scan.stamp, *scan);
  std::size_t kept = 0, bursts = 0;
  Stamp last = -1;
  const auto period = static_cast<double>(stamp_from_seconds(1.0 / 5.5));
  while (auto scan = gappy.next()) {
    ++kept;
    const auto same = all.find(scan->entry.scan.stamp);
    ASSERT_NE(same, all.end());
    EXPECT_EQ(scan->entry.scan.states, same->second.entry.scan.states);
    EXPECT_EQ(scan->entry.odometry->x, same->second.entry.odometry->x);
    if (last >= 0) {
      const auto gap = std::lround(static_cast<double>(scan->entry.scan.stamp - last) / period) - 1;
      bursts += gap > 0;
      if (gap > 0) {
        EXPECT_GE(gap, 2);
        EXPECT_LE(gap, 4);
      }
    }
    last = scan->entry.scan.stamp;
  }
  EXPECT_EQ(kept, gappy.size());
  EXPECT_NEAR(static_cast<double>(bursts) / static_cast<double>(kept), 0.1, 0.06);
}

/// Switches one effect on.
struct Switch {
  const char* name;
  void (*on)(SensorEffects&);
};

const Switch kSwitches[] = {
    {"jitter", [](SensorEffects& e) { e.direction_jitter_deg = 0.2; }},
    {"turn", [](SensorEffects& e) { e.revolution_turn_deg = 0.2; }},
    {"samples", [](SensorEffects& e) { e.sample_rate_hz = 1900.0; }},
    {"dropout", [](SensorEffects& e) { e.dropout_ranges_m = {1.0}, e.dropout_shares = {0.3}; }},
    {"sectors", [](SensorEffects& e) { e.lost_sectors = 0.5; }},
    {"start", [](SensorEffects& e) { e.wrong_start = 0.5; }},
};

TEST(SensorEffects, OneEffectDoesNotChangeTheDrawsOfAnother) {
  for (const Switch& a : kSwitches) {
    LidarOptions alone;
    a.on(alone.effects);
    for (const Switch& b : kSwitches) {
      if (a.name == b.name) continue;
      LidarOptions both = alone;
      b.on(both.effects);
      RevolutionSource first(alone, 9), second(both, 9);
      const bool a_turns = alone.effects.revolution_turn_deg > 0.0 || alone.effects.wrong_start > 0.0;
      const bool b_turns = std::string(b.name) == "turn" || std::string(b.name) == "start";
      const bool offsets = std::string(a.name) == "samples" || std::string(a.name) == "jitter";
      const bool b_offsets = std::string(b.name) == "samples" || std::string(b.name) == "jitter";
      for (int k = 0; k < 5; ++k) {
        const Revolution x = first.next(0.18), y = second.next(0.18);
        if (a_turns && !b_turns) {
          EXPECT_EQ(x.turn, y.turn) << a.name << " " << b.name;
        }
        if (offsets && !b_offsets) {
          for (std::size_t i = 0; i < x.offsets.size(); ++i)
            EXPECT_TRUE(x.offsets[i] == y.offsets[i] || std::isnan(x.offsets[i])) << a.name << " " << b.name;
        }
        if (!x.luck.empty()) {
          EXPECT_EQ(x.luck, y.luck) << a.name << " " << b.name;
        }
        if (alone.effects.lost_sectors > 0.0) {
          EXPECT_EQ(x.gap_first, y.gap_first) << a.name << " " << b.name;
        }
      }
    }
  }
}

TEST(SensorEffects, LossesLeaveTheNoiseOfTheOtherBeams) {
  // What comes after the draws of an old sensor file leaves every beam that is not lost as it was.
  for (const Switch& loss : {kSwitches[3], kSwitches[4]}) {
    LidarOptions plain, lossy;
    loss.on(lossy.effects);
    const auto before = standstill(plain, long_wall(), 10), after = standstill(lossy, long_wall(), 10);
    std::size_t lost = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      for (std::size_t i = 0; i < 360; ++i) {
        if (after[k].is_hit(i)) {
          EXPECT_EQ(after[k].ranges[i], before[k].ranges[i]) << loss.name;
        }
        lost += before[k].is_hit(i) && !after[k].is_hit(i);
      }
    }
    EXPECT_GT(lost, 0U) << loss.name;
  }
}

TEST(SensorEffects, WhatAFileMustNotSayIsNamed) {
  const auto said_of = [](const std::string& text) {
    try {
      parse_lidar(text, "s.yaml");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_NE(said_of(text).find(what), std::string::npos) << text << " -> " << said_of(text);
  };
  says("noise_ranges_m: [1, 2]\nnoise_sigmas_m: [0.1]\n", "noise_sigmas_m: has 1 values; expected as many as");
  says("noise_ranges_m: [2, 1]\nnoise_sigmas_m: [0.1, 0.1]\n", "noise_ranges_m: values must rise");
  says("dropout_ranges_m: [1]\ndropout_shares: [1.5]\n", "dropout_shares: a value is outside");
  says("dropout_ranges_m: [1]\ndropout_shares: [.nan]\n", "dropout_shares: a value is outside");
  says("noise_ranges_m: a\n", "s.yaml:1: noise_ranges_m: expected a list of numbers");
  says("lost_burst_min: 5\nlost_burst_max: 3\n", "s.yaml:2: lost_burst_max: must not be below lost_burst_min");
  says("wrong_start: 2\n", "s.yaml:1: wrong_start: is outside");
  says("like: no-such-sensor\n", "no-such-sensor");
  says("lost_sector_kind: torn\n", "is not one of empty, closed, held");
}

TEST(SensorEffects, AFileMayStartFromAnother) {
  const LidarOptions lidar = parse_lidar("like: ld06\nwrong_start: 0.03\n", "s.yaml");
  EXPECT_EQ(lidar.beams, 450);
  EXPECT_EQ(lidar.effects.wrong_start, 0.03);
  EXPECT_EQ(lidar.range_max_m, read_lidar("ld06").range_max_m);
}

TEST(SensorEffects, ATurnOfSamplesInStepIsSaidBesideByHalfABeam) {
  LidarOptions lidar;
  lidar.beams = 360;
  lidar.fov_deg = 360.0;
  lidar.rate_hz = 10.0;
  EXPECT_EQ(revolution_turn_sigma(lidar), 0.0);
  lidar.effects.revolution_turn_deg = 0.3;
  EXPECT_NEAR(revolution_turn_sigma(lidar), deg_to_rad(0.3), 1e-9);
  lidar.effects.sample_rate_hz = 3600.0;
  EXPECT_NEAR(revolution_turn_sigma(lidar), deg_to_rad(std::hypot(0.3, 1.0 / std::sqrt(12.0))), 1e-9);
  lidar.effects.sample_rate_hz = 3500.0;  // ten beams out of step in a turn
  EXPECT_LT(revolution_turn_sigma(lidar), deg_to_rad(0.302));
}

}  // namespace
}  // namespace phasescan::sim::sensor_effects_test
