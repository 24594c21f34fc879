#include "sim/lidar.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/io/error.hpp"
#include "scan/points.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim::lidar_test {
namespace {

using Eigen::Vector2d;

/// A round room of 3 m, cut into flats so fine that every range from the middle is 3 m within a tenth of a millimetre.
Shape round_room(Material material = Material::kMatt) {
  Shape shape;
  Polygon outline;
  for (int i = 0; i <= 720; ++i)
    outline.push_back({3.0 * std::cos(kTwoPi * i / 720), 3.0 * std::sin(kTwoPi * i / 720)});
  shape.add_line(outline, material);
  return shape;
}

TEST(Lidar, NoiseAndLossesHaveTheirStatistics) {
  const RayCaster caster(round_room());
  LidarOptions lidar;
  lidar.resolution_m = 0.0;
  Random random(3);
  double sum = 0.0, sum2 = 0.0;
  int hits = 0, beams = 0;
  for (int k = 0; k < 200; ++k) {
    const Scan scan = simulate_scan({&caster, nullptr}, lidar, {}, random);
    for (std::size_t i = 0; i < scan.size(); ++i, ++beams) {
      if (!scan.is_hit(i)) continue;
      EXPECT_EQ(scan.states[i], BeamState::kHit);
      sum += static_cast<double>(scan.ranges[i]) - 3.0;
      sum2 += std::pow(static_cast<double>(scan.ranges[i]) - 3.0, 2);
      ++hits;
    }
  }
  // A1: max(1 cm, 1 %) is 3 cm here, and 2 % of the beams are lost; five standard errors of each.
  EXPECT_NEAR(sum / hits, 0.0, 5.0 * 0.03 / std::sqrt(hits));
  EXPECT_NEAR(std::sqrt(sum2 / hits), 0.03, 5.0 * 0.03 / std::sqrt(2.0 * hits));
  EXPECT_NEAR(1.0 - static_cast<double>(hits) / beams, 0.02, 5.0 * std::sqrt(0.02 * 0.98 / beams));
}

TEST(Lidar, ClockwiseAndCounterClockwiseSensorsAgree) {
  const World world = make_world(WorldKind::kFlat, 4);
  const RayCaster caster(world.shape);
  LidarOptions clockwise = LidarOptions{}.noise_free(), other = clockwise;
  other.clockwise = false;
  Random random(1);
  const Pose2 pose{4.0, 3.0, 0.7};
  const Scan a = simulate_scan({&caster, nullptr}, clockwise, pose, random),
             b = simulate_scan({&caster, nullptr}, other, pose, random);
  EXPECT_LT(a.geometry.angle_increment, 0.0);
  EXPECT_GT(b.geometry.angle_increment, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t j = (a.size() - i) % a.size();
    ASSERT_EQ(a.is_hit(i), b.is_hit(j));
    if (a.is_hit(i)) {
      EXPECT_NEAR(a.ranges[i], b.ranges[j], 1e-5);
    }
  }
}

TEST(Lidar, TheTrueTwistTakesTheMotionOutOfAScan) {
  const World world = make_world(WorldKind::kRoom, 4);
  const RayCaster caster(world.shape);
  LidarOptions lidar = LidarOptions{}.noise_free();
  const Polygon& room = world.rooms[0];
  const Pose2 start{0.5 * (room[0].x() + room[2].x()), 0.5 * (room[0].y() + room[2].y()), 0.3};
  const Twist2 twist{0.6, 0.0, deg_to_rad(180.0)};
  const auto moving = [&](double t) { return start * exp_twist(twist, t); };
  Random random(1);
  const Scan scan = simulate_scan({&caster, nullptr}, lidar, moving, 2.0, random);
  EXPECT_EQ(scan.stamp, 2'000'000'000);
  EXPECT_NEAR(scan.time_increment * 360.0 * 5.5, 1.0, 1e-12);
  const auto farthest = [&](const Twist2& known) {
    ScanPoints points;
    scan_to_points(scan, points, 0.0, known);
    double worst = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector2d p = start * Vector2d(points.x[i], points.y[i]);
      double off = 1e9;
      for (const Segment& s : world.shape.segments) off = std::min(off, point_segment_distance(p, s.a, s.b));
      for (const Disc& d : world.shape.discs) off = std::min(off, std::abs((p - d.center).norm() - d.radius));
      worst = std::max(worst, off);
    }
    return worst;
  };
  EXPECT_LT(farthest(twist), 1e-4);
  EXPECT_GT(farthest({}), 0.1);

  // Switched off, the scan is that of standing still.
  lidar.motion = false;
  const Scan still = simulate_scan({&caster, nullptr}, lidar, moving, 2.0, random);
  const Scan standing = simulate_scan({&caster, nullptr}, lidar, start, random);
  EXPECT_EQ(still.states, standing.states);
  for (std::size_t i = 0; i < still.size(); ++i) {
    if (still.is_hit(i)) {
      EXPECT_EQ(still.ranges[i], standing.ranges[i]);
    }
  }
}

TEST(Lidar, GlassIsSeenHeadOnAndSeenThroughElse) {
  Shape shape;
  shape.add_line({{2.0, -5.0}, {2.0, 5.0}}, Material::kGlass);
  shape.add_line({{4.0, -9.0}, {4.0, 9.0}});
  const RayCaster caster(shape);
  const LidarOptions lidar;
  EXPECT_NEAR(cast_beam({&caster, nullptr}, lidar, {0.0, 0.0}, {1.0, 0.0}).range, 2.0, 1e-12);
  const double angle = deg_to_rad(30.0);
  EXPECT_NEAR(cast_beam({&caster, nullptr}, lidar, {0.0, 0.0}, {std::cos(angle), std::sin(angle)}).range,
              4.0 / std::cos(angle), 1e-9);
}

TEST(Lidar, BlackIsSeenFromNearOnly) {
  Shape shape;
  shape.add_line({{1.0, -1.0}, {1.0, 1.0}}, Material::kBlack);
  shape.add_line({{-2.0, -1.0}, {-2.0, 1.0}}, Material::kBlack);
  const RayCaster caster(shape);
  const LidarOptions lidar;
  EXPECT_TRUE(cast_beam({&caster, nullptr}, lidar, {0.0, 0.0}, {1.0, 0.0}).found());
  EXPECT_FALSE(cast_beam({&caster, nullptr}, lidar, {0.0, 0.0}, {-1.0, 0.0}).found());
}

TEST(Lidar, GrazingHitsAreMissedTheMoreTheFlatter) {
  Shape shape;
  shape.add_line({{0.0, -0.4}, {5.9, -0.4}});
  const RayCaster caster(shape);
  LidarOptions lidar;
  lidar.dropout = 0.0;
  lidar.mixed_pixels = 0.0;
  Random random(5);
  int steep = 0, flat = 0, steep_hits = 0, flat_hits = 0;
  for (int k = 0; k < 300; ++k) {
    const Scan scan = simulate_scan({&caster, nullptr}, lidar, {0.0, 0.0, 0.0}, random);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const double below_deg = -rad_to_deg(wrap_angle(scan.angle(i)));
      if (below_deg > 15.0 && below_deg < 60.0) ++steep, steep_hits += scan.is_hit(i);
      if (below_deg > 4.5 && below_deg < 5.5) ++flat, flat_hits += scan.is_hit(i);
    }
  }
  EXPECT_EQ(steep_hits, steep);
  // 5 degrees above the surface is half way from 80 to 90 degrees of incidence.
  EXPECT_NEAR(static_cast<double>(flat_hits) / flat, 0.5, 0.12);
}

TEST(Lidar, MixedPixelsLieBetweenTheirSurfaces) {
  Shape shape;
  shape.add_line({{1.0, 0.0}, {1.0, 2.0}});
  shape.add_line({{3.0, -3.0}, {3.0, 3.0}});
  const RayCaster caster(shape);
  LidarOptions lidar;
  lidar.dropout = 0.0;
  lidar.sigma_m = lidar.sigma_relative = 0.0;
  lidar.mixed_pixels = 1.0;
  lidar.beam_width_deg = 0.5;
  Random random(2);
  int between = 0;
  constexpr int kScans = 200;
  for (int k = 0; k < kScans; ++k) {
    const Scan scan = simulate_scan({&caster, nullptr}, lidar, {0.0, 0.0, 0.0}, random);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      if (!scan.is_hit(i)) continue;
      EXPECT_GE(scan.ranges[i], 0.999F);
      between += scan.ranges[i] > 1.05F && scan.ranges[i] < 2.95F && std::abs(wrap_angle(scan.angle(i))) < 0.001;
    }
  }
  // The beam straight ahead lies on the edge, and says something in between nearly always.
  EXPECT_GT(between, kScans * 8 / 10);
}

TEST(Lidar, EverySensorIsReadable) {
  const auto names = lidar_names();
  ASSERT_GE(names.size(), 7U);
  for (const std::string& name : names) {
    const LidarOptions lidar = read_lidar(name);
    EXPECT_NO_THROW(validate_options(name, lidar));
    EXPECT_GT(lidar.range_max_m, lidar.range_min_m);
  }
  EXPECT_EQ(read_lidar("urg-04lx").beams, 682);
  EXPECT_NEAR(rad_to_deg(read_lidar("urg-04lx").angle_increment() * 681), 240.0, 1e-9);
  EXPECT_THROW(read_lidar("no-such-sensor"), InputError);
}

TEST(Lidar, WhatASensorFileMustNotSayIsNamedWithItsLine) {
  const auto said_of = [](const std::string& text) {
    try {
      parse_lidar(text, "s.yaml");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(said_of("beams: 0\n").find("s.yaml:1: beams: is outside 1"), 0u) << said_of("beams: 0\n");
  EXPECT_EQ(said_of("beams: 9\ndropout: .nan\n").find("s.yaml:2: dropout: is outside 0"), 0u);
  EXPECT_EQ(said_of("beams: 9\nrange_min_m: 9\n").find("s.yaml:2: range_max_m: must be above range_min_m"), 0u);
  EXPECT_EQ(said_of("range_min_m: 7\nrange_max_m: 8\n"), "no error");
}

}  // namespace
}  // namespace phasescan::sim::lidar_test
