#include "eval/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/random.hpp"

namespace phasescan::trajectory_error_test {
namespace {

std::vector<StampedPose> wandering(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<StampedPose> poses;
  Pose2 pose{1.0, -2.0, 0.3};
  for (std::size_t i = 0; i < n; ++i) {
    poses.push_back({stamp_from_seconds(1000.0 + 0.1 * static_cast<double>(i)), pose});
    pose = pose * Pose2{random.uniform(0.0, 0.2), random.normal(0.0, 0.02), random.normal(0.0, 0.2)};
  }
  return poses;
}

std::vector<StampedPose> moved(const Pose2& T, std::vector<StampedPose> poses) {
  for (StampedPose& p : poses) p.pose = T * p.pose;
  return poses;
}

TEST(TrajectoryError, AlignmentTakesOutAnyRigidMotion) {
  const auto reference = wandering(200, 7);
  const Pose2 T{3.0, -4.0, 2.5};
  const auto pairs = associate(moved(T, reference), reference);
  ASSERT_EQ(pairs.estimate.size(), reference.size());
  const Pose2 found = align_se2(pairs);
  EXPECT_NEAR(found.theta, T.inverse().theta, 1e-12);
  EXPECT_NEAR(found.x, T.inverse().x, 1e-9);
  EXPECT_NEAR(found.y, T.inverse().y, 1e-9);
  EXPECT_LT(error_stats(absolute_trajectory_errors(pairs)).rmse, 1e-9);
  EXPECT_GT(error_stats(absolute_trajectory_errors(pairs, false)).rmse, 1.0);
}

TEST(TrajectoryError, AlignmentBeatsEveryOtherMotionNearby) {
  const auto reference = wandering(60, 3);
  auto estimate = reference;
  Random random(5);
  for (StampedPose& p : estimate) p.pose.x += random.normal(0.0, 0.1), p.pose.y += random.normal(0.0, 0.1);
  const auto pairs = associate(moved({1.0, 2.0, -1.0}, estimate), reference);
  const double best = error_stats(absolute_trajectory_errors(pairs)).sse;
  const Pose2 found = align_se2(pairs);
  for (const Pose2& d : {Pose2{0.01, 0, 0}, Pose2{-0.01, 0, 0}, Pose2{0, 0.01, 0}, Pose2{0, -0.01, 0},
                         Pose2{0, 0, 0.01}, Pose2{0, 0, -0.01}}) {
    double sse = 0.0;
    for (std::size_t i = 0; i < pairs.estimate.size(); ++i) {
      const Pose2 p = d * (found * pairs.estimate[i]);
      sse += std::pow(translation_distance(p, pairs.reference[i]), 2);
    }
    EXPECT_GT(sse, best);
  }
}

TEST(TrajectoryError, HandValues) {
  // Three poses on a line; the estimate's last is 0.3 m to the side: without alignment the errors are 0, 0, 0.3.
  AssociatedPoses pairs;
  pairs.reference = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  pairs.estimate = {{0, 0, 0}, {1, 0, 0.1}, {2, 0.3, 0}};
  const ErrorStats ate = error_stats(absolute_trajectory_errors(pairs, false));
  EXPECT_EQ(ate.n, 3u);
  EXPECT_NEAR(ate.mean, 0.1, 1e-12);
  EXPECT_NEAR(ate.rmse, std::sqrt(0.03), 1e-12);
  EXPECT_NEAR(ate.std, std::sqrt(0.02), 1e-12);
  EXPECT_NEAR(ate.median, 0.0, 1e-12);
  EXPECT_NEAR(ate.max, 0.3, 1e-12);
  // Steps: first (1, 0, 0.1) against (1, 0, 0); second R(-0.1) (1, 0.3) with -0.1 against (1, 0, 0).
  const RelativeErrors rpe = relative_pose_errors(pairs);
  ASSERT_EQ(rpe.translation.size(), 2u);
  EXPECT_NEAR(rpe.translation[0], 0.0, 1e-12);
  EXPECT_NEAR(rpe.rotation[0], 0.1, 1e-12);
  const double x = std::cos(0.1) + 0.3 * std::sin(0.1), y = -std::sin(0.1) + 0.3 * std::cos(0.1);
  EXPECT_NEAR(rpe.translation[1], std::hypot(x - 1.0, y), 1e-12);
  EXPECT_NEAR(rpe.rotation[1], 0.1, 1e-12);
}

TEST(TrajectoryError, StepsInFramesAndMetres) {
  AssociatedPoses pairs;
  for (int i = 0; i < 10; ++i) pairs.reference.push_back({0.5 * i, 0, 0}), pairs.estimate.push_back({0.5 * i, 0, 0});
  EXPECT_EQ(relative_pose_errors(pairs, 3).translation.size(), 3u);                       // 0-3-6-9
  EXPECT_EQ(relative_pose_errors(pairs, 1.0, StepUnit::kMetres).translation.size(), 3u);  // ends at 1, 2, 3, 4 m
  EXPECT_THROW(relative_pose_errors(pairs, 0.0), std::invalid_argument);
}

TEST(TrajectoryError, PairsByTimeWhateverTheOrder) {
  auto reference = wandering(50, 9);
  auto estimate = reference;
  std::swap(estimate[3], estimate[40]);
  estimate.erase(estimate.begin() + 10);
  estimate[5].stamp += 400'000'000'000;
  const auto pairs = associate(estimate, reference);
  EXPECT_EQ(pairs.estimate.size(), 48u);
  EXPECT_LT(error_stats(absolute_trajectory_errors(pairs, false)).max, 1e-12);
  EXPECT_TRUE(associate({}, reference).estimate.empty());
}

}  // namespace
}  // namespace phasescan::trajectory_error_test
