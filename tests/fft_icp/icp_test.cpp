#include "fft_icp/icp/icp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/rooms.hpp"

namespace phasescan::icp_test {
namespace {

ScanPoints random_points(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  ScanPoints points;
  for (std::size_t i = 0; i < n; ++i) {
    points.x.push_back(static_cast<float>(random.uniform(-3, 3)));
    points.y.push_back(static_cast<float>(random.uniform(-3, 3)));
    points.range.push_back(std::hypot(points.x.back(), points.y.back()));
    points.beam.push_back(static_cast<int>(i));
  }
  return points;
}

ScanPoints room_points(const Pose2& pose, int beams = 360, double noise = 0.0, std::uint64_t seed = 1) {
  ScanPoints points;
  scan_to_points(test::cast_room(pose, beams, noise, 0.0, seed), points);
  return points;
}

TEST(PointIndex, FindsTheTwoNearestLikeBruteForce) {
  const ScanPoints points = random_points(300, 1);
  PointIndex index;
  index.build(points);
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const auto x = static_cast<float>(random.uniform(-4, 4)), y = static_cast<float>(random.uniform(-4, 4));
    float best = std::numeric_limits<float>::infinity(), second = best;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const float d = std::hypot(points.x[k] - x, points.y[k] - y);
      if (d < best) {
        second = best;
        best = d;
      } else if (d < second) {
        second = d;
      }
    }
    const NearestPair found = index.nearest(x, y);
    EXPECT_NEAR(found.distance, best, 1e-5);
    EXPECT_NEAR(found.second_distance, second, 1e-5);
    EXPECT_NEAR(std::hypot(index.x(found.index) - x, index.y(found.index) - y), best, 1e-5);
  }
}

TEST(PointIndex, EmptyAndSinglePointSets) {
  PointIndex index;
  index.build({});
  EXPECT_EQ(index.nearest(0, 0).index, -1);
  index.build(random_points(1, 3));
  EXPECT_EQ(index.nearest(0, 0).index, 0);
  EXPECT_TRUE(std::isinf(index.nearest(0, 0).second_distance));
}

TEST(RigidMotion, TakesPointsOntoPoints) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Pose2 truth{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-kPi, kPi)};
    const ScanPoints points = random_points(10, static_cast<std::uint64_t>(i));
    Eigen::Vector2d mean_s = Eigen::Vector2d::Zero(), mean_m = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < 10; ++k) {
      const Eigen::Vector2d s(points.x[k], points.y[k]);
      mean_s += s / 10;
      mean_m += truth * s / 10;
    }
    Eigen::Matrix2d cross = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < 10; ++k) {
      const Eigen::Vector2d s(points.x[k], points.y[k]);
      cross += (s - mean_s) * (truth * s - mean_m).transpose();
    }
    const Pose2 found = rigid_motion(cross, mean_s, mean_m);
    EXPECT_LT(translation_distance(found, truth), 1e-9);
    EXPECT_LT(angle_distance(found.theta, truth.theta), 1e-9);
  }
}

TEST(RigidMotion, CollinearPointsAreNeverReflected) {
  // Points on a line: the second singular value is 0 and its sign is free, so V U^T may be a reflection.
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const double line = random.uniform(-kPi, kPi), turn = random.uniform(-0.5, 0.5);
    const Eigen::Vector2d s(std::cos(line), std::sin(line)), m(std::cos(line + turn), std::sin(line + turn));
    Eigen::Matrix2d cross = s * m.transpose();
    cross(0, 0) += random.uniform(-1e-12, 1e-12);
    cross(1, 0) += random.uniform(-1e-12, 1e-12);
    EXPECT_LT(angle_distance(rigid_motion(cross, {0, 0}, {0, 0}).theta, turn), 1e-6);
  }
}

TEST(Icp, MovesTheScanOntoTheReference) {
  PointIndex index;
  index.build(room_points({}, 720, 0.01, 1));
  const Pose2 truth{0.15, -0.1, deg_to_rad(6.0)};
  const IcpResult found = Icp().align(index, room_points(truth, 360, 0.01, 2), {}, true);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(translation_distance(found.T_ref_scan, truth), 0.015);
  EXPECT_LT(angle_distance(found.T_ref_scan.theta, truth.theta), deg_to_rad(0.4));
  EXPECT_GT(found.overlap, 0.9);
}

TEST(Icp, KeptNeighboursAreTheTrueOnes) {
  // The pairs of the last iteration, found with neighbours kept from earlier ones, against a fresh search at the last
  // pose but one: at rest both poses are the same to the tolerance.
  const ScanPoints reference = room_points({}, 360, 0.01, 3), scan = room_points({0.1, 0.05, 0.05}, 360, 0.01, 4);
  PointIndex index;
  index.build(reference);
  Icp icp;
  const IcpResult found = icp.align(index, scan, {}, true);
  ASSERT_TRUE(found.converged);
  for (const PointPair& pair : icp.pairs()) {
    const auto i = static_cast<std::size_t>(pair.scan);
    const Eigen::Vector2d p = found.T_ref_scan * Eigen::Vector2d(scan.x[i], scan.y[i]);
    const NearestPair nearest = index.nearest(static_cast<float>(p.x()), static_cast<float>(p.y()));
    const double kept = std::hypot(static_cast<double>(index.x(pair.reference)) - p.x(),
                                   static_cast<double>(index.y(pair.reference)) - p.y());
    EXPECT_NEAR(kept, static_cast<double>(nearest.distance), 1e-3);
  }
}

TEST(Icp, NeverTakesMoreIterationsThanAllowed) {
  IcpOptions options;
  options.max_iterations = 3;
  PointIndex index;
  index.build(room_points({}));
  const IcpResult found = Icp(options).align(index, room_points({0.4, 0.3, 0.4}), {}, false);
  EXPECT_EQ(found.iterations, 3);
  EXPECT_FALSE(found.converged);
}

TEST(Icp, WithoutAnyPairTheGuessStays) {
  PointIndex index;
  index.build(room_points({}));
  const Pose2 far{500.0, 0.0, 0.3};
  const IcpResult found = Icp().align(index, room_points({}), far, true);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.T_ref_scan.x, far.x);
  EXPECT_EQ(found.pairs, 0);
}

TEST(Icp, TrimKeepsTheNearestShare) {
  IcpOptions options;
  options.trim = 0.5;
  PointIndex index;
  index.build(room_points({}));
  Icp icp(options);
  const ScanPoints scan = room_points({0.02, 0.0, 0.0});
  icp.align(index, scan, {}, true);
  EXPECT_NEAR(static_cast<double>(icp.pairs().size()), 0.5 * static_cast<double>(scan.size()), 2.0);
}

TEST(Covariance, IsWideAlongACorridorAndNarrowAcross) {
  ScanPoints corridor;
  for (int i = 0; i < 200; ++i) {
    corridor.x.push_back(-3.0F + 0.06F * static_cast<float>(i % 100));
    corridor.y.push_back(i < 100 ? 1.0F : -1.0F);
    corridor.range.push_back(1.0F);
    corridor.beam.push_back(i);
  }
  std::vector<PointPair> pairs;
  for (int i = 0; i < 200; ++i) pairs.push_back({i, i});
  const Eigen::Matrix3d c = surface_covariance(corridor, corridor, {}, pairs);
  EXPECT_GT(c(0, 0), 1e3);
  EXPECT_LT(c(1, 1), 1e-3);
  EXPECT_LE(c.diagonal().maxCoeff(), kUnknownVariance);
  EXPECT_LT((c - c.transpose()).norm(), 1e-6 * c.norm());
}

TEST(Covariance, IsTheInverseOfTheInformationWhereThatExists) {
  Eigen::Matrix3d a;
  a << 4, 1, 0.5, 1, 3, 0.2, 0.5, 0.2, 9;
  EXPECT_LT((covariance_from_information(a) * a - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(covariance_from_information(Eigen::Matrix3d::Zero())(1, 1), kUnknownVariance);
}

}  // namespace
}  // namespace phasescan::icp_test
