#include "fft_icp/ndt/ndt.hpp"

#include <gtest/gtest.h>

#include "support/rooms.hpp"

namespace phasescan::ndt_test {
namespace {

ScanPoints room_points(const Pose2& pose, std::uint64_t seed = 1) {
  ScanPoints points;
  scan_to_points(test::cast_room(pose, 360, 0.01, 0.0, seed), points);
  return points;
}

Pose2 nudged(Pose2 pose, int axis, double by) {
  (axis == 0 ? pose.x : axis == 1 ? pose.y : pose.theta) += by;
  return pose;
}

TEST(Ndt, GradientAndHessianAreThoseOfTheScore) {
  NdtMap map;
  map.build(room_points({}), 1.0, NdtOptions{});
  // Few points, well inside cells: the score itself jumps where a point changes its cell.
  const ScanPoints scan = room_points({0.05, 0.02, 0.03}, 2);
  Random random(3);
  for (int trial = 0; trial < 5; ++trial) {
    const Pose2 pose{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05)};
    const NdtScore at = map.evaluate(scan, pose);
    const double h = 1e-7;
    for (int axis = 0; axis < 3; ++axis) {
      const NdtScore plus = map.evaluate(scan, nudged(pose, axis, h)),
                     minus = map.evaluate(scan, nudged(pose, axis, -h));
      EXPECT_NEAR((plus.value - minus.value) / (2 * h), at.gradient(axis), 1e-3 * (1.0 + at.gradient.norm()));
      const Eigen::Vector3d column = (plus.gradient - minus.gradient) / (2 * h);
      EXPECT_LT((column - at.hessian.col(axis)).norm(), 1e-3 * (1.0 + at.hessian.norm()));
    }
  }
}

TEST(Ndt, MovesTheScanOntoTheReference) {
  const NdtOptions options;
  NdtLevels reference;
  build_ndt(room_points({}), options, reference);
  const Pose2 truth{0.2, -0.15, deg_to_rad(7.0)};
  const NdtResult found = align_ndt(reference, room_points(truth, 4), {}, options);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(translation_distance(found.T_ref_scan, truth), 0.02);
  EXPECT_LT(angle_distance(found.T_ref_scan.theta, truth.theta), deg_to_rad(0.5));
  EXPECT_GT(found.overlap, 0.8);
}

TEST(Ndt, TheScoreIsLowestAtTheTruth) {
  NdtMap map;
  map.build(room_points({}), 0.5, NdtOptions{});
  const ScanPoints scan = room_points({}, 5);
  const double best = map.evaluate(scan, {}).value;
  for (const Pose2& pose : {Pose2{0.1, 0, 0}, Pose2{0, -0.1, 0}, Pose2{0, 0, 0.1}})
    EXPECT_LT(best, map.evaluate(scan, pose).value);
}

TEST(Ndt, NoPointsAndFarPointsAreHarmless) {
  const NdtOptions options;
  NdtLevels reference;
  build_ndt({}, options, reference);
  EXPECT_FALSE(align_ndt(reference, room_points({}), {}, options).converged);
  ScanPoints wild = room_points({});
  wild.x[0] = 250000.0F;
  build_ndt(wild, options, reference);
  EXPECT_TRUE(align_ndt(reference, room_points({}), {}, options).converged);
}

}  // namespace
}  // namespace phasescan::ndt_test
