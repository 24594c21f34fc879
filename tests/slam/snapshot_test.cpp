// Snapshots of a back end: what they hold stays as it was, drawn step by step they give the map of all scans, and they
// can be asked for while a batch is worked on.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "slam/backend.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::snapshot_test {
namespace {

using testing::toy_keyframes;
using testing::toy_tour;
using testing::two_rooms;

/// Keyframes with their scans, with an odometry that turns too far.
std::vector<Keyframe> drive(int laps, double bias) {
  const auto tour = toy_tour(0.5, 0.4, 0.5, laps);
  std::vector<Pose2> odometry = {tour[0]};
  for (std::size_t i = 1; i < tour.size(); ++i)
    odometry.push_back(odometry.back() * tour[i - 1].inverse() * tour[i] * Pose2{0.0, 0.0, bias});
  Random random(6), again(6);
  auto keyframes = toy_keyframes(two_rooms(), tour, random, {}, [&](std::size_t i) { return odometry[i]; });
  ScanStore store;
  for (std::size_t i = 0; i < tour.size(); ++i)
    keyframes[i].stored = store.stored(store.add(testing::toy_scan(two_rooms(), tour[i], {}, again, 0), {}));
  return keyframes;
}

std::vector<Keyframe> batch_at(const std::vector<Keyframe>& keyframes, std::size_t from) {
  const auto begin = keyframes.begin() + static_cast<std::ptrdiff_t>(from);
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min<std::size_t>(10, keyframes.size() - from))};
}

TEST(Snapshot, DrawnStepByStepIsTheSameAsDrawnAtOnce) {
  const auto keyframes = drive(2, 0.002);
  SlamOptions options;
  Backend backend(options);
  SnapshotRenderer viewer(options.map, true, true);
  std::uint64_t last = 0;
  for (std::size_t from = 0; from < keyframes.size(); from += 10) {
    backend.add_batch(batch_at(keyframes, from));
    const auto snapshot = backend.snapshot();
    EXPECT_EQ(snapshot->version, ++last);
    ASSERT_EQ(snapshot->nodes.size(), backend.keyframes().size());
    const TrinaryMap map = viewer.map(*snapshot);
    const TrinaryMap at_once = SnapshotRenderer(options.map, true, true).map(*snapshot);
    ASSERT_EQ(map.cells, at_once.cells) << from;
    EXPECT_GT(map.cells.size(), 1000u);
  }
  EXPECT_GT(backend.snapshot()->optimisations, 0u);
  EXPECT_GT(backend.snapshot()->loops.size(), 10u);
}

TEST(Snapshot, WhatItHoldsStaysAsItWas) {
  const auto keyframes = drive(2, 0.002);
  Backend backend({});
  std::vector<std::shared_ptr<const BackendSnapshot>> kept;
  std::vector<std::vector<Pose2>> poses;
  std::vector<std::size_t> loops;
  for (std::size_t from = 0; from < keyframes.size(); from += 10) {
    backend.add_batch(batch_at(keyframes, from));
    kept.push_back(backend.snapshot());
    poses.push_back(backend.poses());
    loops.push_back(kept.back()->loops.size());
    const Pose2 now = kept.back()->T_map_odom * keyframes[std::min(keyframes.size(), from + 10) - 1].T_odom_base;
    EXPECT_LT(translation_distance(now, backend.submitted_pose(backend.submitted() - 1)), 1e-9);
  }
  backend.finish();
  EXPECT_EQ(backend.snapshot()->version, kept.size() + 1);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ASSERT_EQ(kept[i]->poses.size(), poses[i].size());
    for (std::size_t k = 0; k < poses[i].size(); ++k) EXPECT_EQ(kept[i]->poses[k], poses[i][k]);
    EXPECT_EQ(kept[i]->nodes.size(), poses[i].size());
    EXPECT_EQ(kept[i]->loops.size(), loops[i]);
    // Shared, not copied.
    EXPECT_EQ(kept[i]->nodes[3].stored, kept.back()->nodes[3].stored);
    if (i > 7) {
      EXPECT_EQ(&kept[i]->nodes[3], &kept.back()->nodes[3]);
    }
  }
}

TEST(Snapshot, CanBeAskedForWhileABatchIsWorkedOn) {
  const auto keyframes = drive(1, 0.002);
  Backend backend({});
  EXPECT_NE(backend.snapshot(), nullptr);
  std::atomic<bool> done{false};
  std::uint64_t seen = 0;
  std::thread viewer([&] {
    while (!done) {
      const auto snapshot = backend.snapshot();
      EXPECT_GE(snapshot->version, seen);
      EXPECT_EQ(snapshot->nodes.size(), snapshot->poses.size());
      seen = snapshot->version;
    }
  });
  for (std::size_t from = 0; from < keyframes.size(); from += 10) backend.add_batch(batch_at(keyframes, from));
  done = true;
  viewer.join();
  EXPECT_LE(seen, backend.snapshot()->version);
}

TEST(Snapshot, CovarianceGrowsAlongTheWayAndALoopBoundsIt) {
  auto keyframes = drive(2, 0.0);
  for (Keyframe& k : keyframes) k.information = Eigen::Vector3d(1e3, 1e3, 1e4).asDiagonal();
  SlamOptions options;
  options.loops.enabled = false;
  Backend alone(options), with_loops({});
  double before = -1.0;
  for (std::size_t from = 0; from < keyframes.size(); from += 10) {
    alone.add_batch(batch_at(keyframes, from));
    with_loops.add_batch(batch_at(keyframes, from));
    // That of the position falls on the way back: the turn of the first steps then moves it less.
    const double turn = alone.snapshot()->covariance(2, 2);
    EXPECT_GT(turn, before);
    before = turn;
  }
  // A chain of steps: the covariance followed from step to step is that of the graph.
  const Eigen::Matrix3d chain = *alone.graph().covariance(static_cast<int>(keyframes.size()) - 1);
  EXPECT_LT((alone.covariance() - chain).norm(), 1e-6 * chain.norm());
  const auto variance = [](const Eigen::Matrix3d& covariance) { return covariance(0, 0) + covariance(1, 1); };
  EXPECT_LT(variance(with_loops.covariance()), 0.3 * variance(chain));
  with_loops.finish();
  const Eigen::Matrix3d at_end = *with_loops.graph().covariance(static_cast<int>(keyframes.size()) - 1);
  EXPECT_LT((with_loops.covariance() - at_end).norm(), 1e-6 * at_end.norm());
}

TEST(Snapshot, AfterABreakCovarianceIsOfTheNewPiece) {
  auto keyframes = drive(1, 0.0);
  keyframes[30].new_segment = true;
  SlamOptions options;
  options.loops.enabled = false;
  Backend backend(options);
  backend.add_batch({keyframes.begin(), keyframes.begin() + 31});
  EXPECT_EQ(backend.covariance().norm(), 0.0);
  EXPECT_EQ(backend.snapshot()->pieces.count, 2);
}

TEST(Snapshot, InBoundedMemoryTheCovarianceStaysThatOfTheMapAndOneMatch) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  const auto keyframes = drive(5, 0.0);
  Backend backend(options);
  double largest = 0.0;
  for (std::size_t from = 0; from < keyframes.size(); from += 10) {
    backend.add_batch(batch_at(keyframes, from));
    largest = std::max(largest, std::sqrt(backend.covariance()(0, 0) + backend.covariance()(1, 1)));
  }
  EXPECT_LT(backend.keyframes().size(), keyframes.size() / 2);
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(largest, 0.3);
}

}  // namespace
}  // namespace phasescan::snapshot_test
