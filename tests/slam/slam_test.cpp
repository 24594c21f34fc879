#include "phasescan/slam/slam.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/trajectory_error.hpp"
#include "output/g2o.hpp"
#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "support/toy_world.hpp"

namespace phasescan {
namespace {

using testing::toy_scan;
using testing::toy_tour;
using testing::ToyLidar;
using testing::two_rooms;

struct TourResult {
  std::string bytes;
  ErrorStats ate;
  LoopCounts loops;
};

TourResult run_tour(SlamOptions options, int threads, int laps) {
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.4, 1.2, laps);
  Random random(33);
  Slam slam(options, threads);
  AssociatedPoses pairs;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    slam.add({toy_scan(walls, tour[i], {}, random, stamp_from_seconds(0.18 * static_cast<double>(i)))});
    pairs.reference.push_back(tour[i]);
  }
  slam.finish();
  pairs.estimate = slam.trajectory();
  std::vector<StampedPose> stamped;
  for (std::size_t i = 0; i < tour.size(); ++i) stamped.push_back({slam.records()[i].stamp, pairs.estimate[i]});
  return {format_tum(stamped) + format_g2o(slam.backend().graph()) + format_pgm(make_trinary(slam.render_map())),
          error_stats(absolute_trajectory_errors(pairs)), slam.backend().loop_counts()};
}

TEST(Slam, TwoLapsWithLoopsAreAccurate) {
  SlamOptions options;
  const TourResult run = run_tour(options, 1, 2);
  EXPECT_LT(run.ate.rmse, 0.01);
  EXPECT_LT(run.ate.max, 0.04);
  EXPECT_GT(run.loops.accepted, 20u);
}

TEST(Slam, SameBytesForOneAndTwoThreadsAndTwice) {
  SlamOptions options;
  const TourResult one = run_tour(options, 1, 2), again = run_tour(options, 1, 2), two = run_tour(options, 2, 2);
  EXPECT_EQ(one.bytes, again.bytes);
  EXPECT_EQ(one.bytes, two.bytes);
}

TEST(Slam, WhatIsAskedForWhileABatchIsInWorkIsTheSameForOneAndTwoThreads) {
  // A batch each keyframe, and a first scan with nothing in it: the scan after the first keyframe unbends that one.
  const auto ask = [](int threads) {
    SlamOptions options;
    options.slam.batch_nodes = 1;
    options.slam.polish = false;
    const auto walls = two_rooms();
    const auto tour = toy_tour(0.18, 0.5, 1.5);
    Random random(8);
    ToyLidar lidar;
    lidar.turn_s = 0.18;
    Slam slam(options, threads);
    std::string said;
    const auto say = [&said](const Pose2& p) {
      said += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.theta) + "\n";
    };
    slam.add({});
    for (std::size_t i = 0; i + 1 < tour.size(); ++i) {
      const Twist2 step = log_pose(tour[i].inverse() * tour[i + 1]);
      const Twist2 twist{step.vx / 0.18, step.vy / 0.18, step.omega / 0.18};
      slam.add(
          {toy_scan(walls, tour[i], lidar, random, stamp_from_seconds(1.0 + 0.18 * static_cast<double>(i)), twist)});
      if (i % 5 != 0) continue;
      for (const Pose2& p : slam.trajectory()) say(p);
      for (const Pose2& p : slam.odometry_trajectory()) say(p);
      if (const auto p = slam.pose_on_map(i)) say(*p);
      said += std::to_string(slam.backend().loop_counts().compared) + "\n";
    }
    slam.finish();
    return said + format_pgm(make_trinary(slam.render_map()));
  };
  const std::string one = ask(1);
  EXPECT_GT(one.size(), 10000u);
  EXPECT_TRUE(one == ask(2));
}

TEST(Slam, BoundedMemoryKeepsTheMapAndStopsGrowingInAKnownWorld) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.18, 0.4, 1.2, 6);
  Random random(5);
  Slam slam(options);
  AssociatedPoses pairs;
  std::size_t nodes_halfway = 0;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    slam.add({toy_scan(walls, tour[i], {}, random, stamp_from_seconds(0.18 * static_cast<double>(i)))});
    if (i == tour.size() / 2) nodes_halfway = slam.backend().keyframes().size();
  }
  slam.finish();
  pairs.reference = tour;
  pairs.estimate = slam.trajectory();
  EXPECT_LT(error_stats(absolute_trajectory_errors(pairs)).rmse, 0.03);
  EXPECT_LT(slam.backend().keyframes().size(), nodes_halfway + nodes_halfway / 10 + 5);
  EXPECT_EQ(slam.scans().size(), 0u);
  EXPECT_GT(make_trinary(slam.render_map()).cells.size(), 10000u);
}

TEST(Slam, OnePosePerScanWhateverComes) {
  Slam slam;
  Random random(1);
  const auto walls = two_rooms();
  slam.add({});
  slam.add({make_scan(std::vector<float>(100, 0.0F), {-1.0, 0.01, 0.0, 0.0})});
  for (int i = 0; i < 5; ++i) slam.add({toy_scan(walls, {0.02 * i, 0, 0}, {}, random, stamp_from_seconds(0.1 * i))});
  slam.repeat({toy_scan(walls, {0.08, 0, 0}, {}, random, stamp_from_seconds(0.4))});
  slam.finish();
  ASSERT_EQ(slam.trajectory().size(), 8u);
  for (const Pose2& p : slam.trajectory()) EXPECT_TRUE(p.is_finite());
  EXPECT_EQ(slam.trajectory()[7].x, slam.trajectory()[6].x);
}

TEST(Slam, TheFirstKeyframeIsDrawnAsUnbentAsTheOthers) {
  ToyLidar lidar;
  lidar.turn_s = 0.18;
  const Twist2 turning{0.0, 0.0, 1.0};
  Random random(4);
  Slam slam;
  for (int i = 0; i < 6; ++i) {
    slam.add({toy_scan(two_rooms(), {0, 0, 0.18 * i}, lidar, random, stamp_from_seconds(1.0 + 0.18 * i), turning)});
  }
  slam.finish();
  EXPECT_NEAR(slam.backend().keyframes().front().twist.omega, 1.0, 0.1);
}

TEST(ScanStore, KeepsRangesAndReasonsAndMakesNoWallOfWhatIsTooFar) {
  ScanStore store;
  const Scan scan = make_scan(std::vector<float>{0.5F, 129.9F, 140.0F, 0.0F, 999.0F}, {0.0, 0.01, 0.1, 200.0});
  const Scan kept = store.scan(store.add(scan, {}));
  EXPECT_NEAR(kept.ranges[0], 0.5F, 0.0011F);
  EXPECT_NEAR(kept.ranges[1], 129.9F, 0.0011F);
  EXPECT_EQ(kept.states[2], BeamState::kOutOfRange);
  EXPECT_EQ(kept.states[3], scan.states[3]);
  EXPECT_EQ(kept.states[4], scan.states[4]);
}

TEST(ScanStore, AMountingThatJittersMakesNoKindOfItsOwn) {
  ScanStore store;
  const Scan scan = make_scan(std::vector<float>(360, 2.0F), {0.0, 0.017, 0.1, 8.0});
  for (int i = 0; i < 50; ++i) store.add(scan, {0.1, 0.0, 1e-15 * i});
  EXPECT_EQ(store.kinds(), 1u);
  EXPECT_EQ(store.T_base_laser(40).theta, 1e-15 * 40);
}

TEST(Slam, NothingAtAllIsAnEmptyMap) {
  Slam slam;
  slam.finish();
  EXPECT_TRUE(slam.trajectory().empty());
  EXPECT_EQ(make_trinary(slam.render_map()).cells.size(), 1u);
}

}  // namespace
}  // namespace phasescan
