// Which earlier nodes a new one is compared with, and which loops are rejected at once.
#include "slam/loop_closer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>

#include "slam/backend.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::loop_closer_test {
namespace {

using testing::toy_keyframes;
using testing::two_rooms;

/// A graph of keyframes whose odometry is exact, and a closer that finds loops by the map alone.
struct Driven {
  explicit Driven(const std::vector<Pose2>& poses, SlamOptions options = {}) : session(options.loops) {
    options.loops.places = false;
    Random random(6);
    for (Keyframe& keyframe : toy_keyframes(two_rooms(), poses, random)) {
      connectivity.add_node(session.last_node());
      session.insert_node(std::move(keyframe));
    }
    closer.emplace(options);
    places.emplace(options.loops);
    closer->begin_batch(session);
  }
  std::vector<Loop> search() { return closer->search(session.last_node(), session, *places, connectivity); }

  GraphSession session;
  Connectivity connectivity;
  std::optional<LoopCloser> closer;
  std::optional<PlaceSearch> places;
};

void add_pass(std::vector<Pose2>& poses, double from, double to, double y) {
  const int steps = static_cast<int>(std::lround(std::abs(to - from) / 0.25));
  for (int k = 0; k <= steps; ++k) poses.push_back({from + (to - from) * k / steps, y, 0.0});
}

constexpr int kPassNodes = 17, kAwayNodes = 25;

/// By (0, 0) at y = 0.8, away, by it at y = 0.1, away, and there: two visits of 17 nodes, their ninth the nearest.
std::vector<Pose2> two_visits() {
  std::vector<Pose2> poses;
  for (const double y : {0.8, 0.1}) {
    add_pass(poses, -2.0, 2.0, y);
    add_pass(poses, 8.5, 2.5, y - 1.5);
  }
  poses.push_back({0.0, 0.0, 0.0});
  return poses;
}

TEST(LoopCloser, OfAVisitTheNodeThatLooksMostAtThePlaceIsTheAnchorAndTheNearestVisitComesFirst) {
  SlamOptions options;
  options.loops.clusters_per_node = 1;
  Driven driven(two_visits(), options);
  const std::vector<Loop> loops = driven.search();
  ASSERT_EQ(loops.size(), 1U);
  const int nearest = kPassNodes + kAwayNodes + kPassNodes / 2;
  EXPECT_LE(std::abs(loops[0].from - nearest), 2) << "anchors are multiples of four";
  options.loops.clusters_per_node = 2;
  Driven both(two_visits(), options);
  const std::vector<Loop> two = both.search();
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].from, loops[0].from);
  EXPECT_LE(std::abs(two[1].from - kPassNodes / 2), 2);
}

TEST(LoopCloser, TheWayWithoutConfirmationWidensWhereVisitsAreLookedFor) {
  // Back to 3.6 m from where it began, after 160 m: 3 m do not reach, a hundredth of the way on top does.
  std::vector<Pose2> poses;
  for (int k = 0; k < 8; ++k) poses.push_back({-2.0 - 0.02 * k, 0.0, 0.0});
  for (int k = 0; k < 100; ++k) poses.push_back({k % 2 == 0 ? 8.5 : 7.0, 0.0, 0.0});
  poses.push_back({1.6, 0.0, 0.0});
  Driven unconfirmed(poses), confirmed(poses);
  ASSERT_GT(unconfirmed.session.unconfirmed_m(), 100.0);
  confirmed.session.confirm_position();
  static_cast<void>(unconfirmed.search());
  static_cast<void>(confirmed.search());
  EXPECT_EQ(unconfirmed.closer->state().compared, 1U);
  EXPECT_EQ(confirmed.closer->state().compared, 0U);
}

TEST(LoopCloser, ALoopMayAskForNoMoreThanTrackingLeavesOpen) {
  Driven driven(two_visits());
  const int last = driven.session.last_node(), from = last - 30;
  const auto& poses = driven.session.poses();
  Loop loop;
  loop.from = from;
  loop.to = last;
  loop.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
  loop.overlap = 0.95;
  const Pose2 as_mapped = poses[static_cast<std::size_t>(from)].inverse() * poses.back();
  loop.T_from_to = as_mapped * Pose2{0.05, 0.0, 0.0};
  EXPECT_EQ(driven.closer->submit(loop, driven.session, driven.connectivity).size(), 1U);
  EXPECT_EQ(driven.closer->state().beyond, 0U);
  loop.T_from_to = as_mapped * Pose2{5.0, 0.0, 0.0};
  EXPECT_TRUE(driven.closer->submit(loop, driven.session, driven.connectivity).empty());
  EXPECT_EQ(driven.closer->state().beyond, 1U);
  EXPECT_TRUE(driven.closer->state().consistency.waiting.empty()) << "no votes make it right";
}

std::unique_ptr<Backend> mapped(const std::vector<Pose2>& poses, const SlamOptions& options) {
  Random random(7);
  auto backend = std::make_unique<Backend>(options);
  for (Keyframe& keyframe : toy_keyframes(two_rooms(), poses, random)) {
    std::vector<Keyframe> batch;
    batch.push_back(std::move(keyframe));
    backend->add_batch(std::move(batch));
  }
  return backend;
}

std::vector<PoseEdge> loops_of_finished(const std::vector<Pose2>& poses) {
  const auto backend = mapped(poses, {});
  backend->finish();
  std::vector<PoseEdge> loops;
  for (const PoseEdge& edge : backend->graph().edges()) {
    if (edge.robust) loops.push_back(edge);
  }
  return loops;
}

TEST(LoopCloser, AtTheEndNodesAreComparedWithLaterVisitsToo) {
  std::size_t later = 0, earlier = 0;
  for (const PoseEdge& loop : loops_of_finished(two_visits())) ++(loop.from > loop.to ? later : earlier);
  EXPECT_GT(later, 5U);
  EXPECT_GT(earlier, 5U);
}

TEST(LoopCloser, NodesJustBeforeAreNoVisitHoweverNear) {
  // Ten nodes a turn round a small circle: what is nearest is ten nodes away.
  std::vector<Pose2> poses;
  for (int k = 0; k < 60; ++k) poses.push_back({0.5 * std::cos(0.2 * kPi * k), 0.5 * std::sin(0.2 * kPi * k), 0.0});
  const std::vector<PoseEdge> loops = loops_of_finished(poses);
  EXPECT_GT(loops.size(), 10U);
  for (const PoseEdge& loop : loops) {
    EXPECT_GE(std::abs(loop.from - loop.to), LoopOptions().min_nodes_apart - 2)
        << loop.from << " " << loop.to << ": anchors are multiples of four";
  }
}

TEST(LoopCloser, PlacesAreSearchedOnlyAfterAWayWithoutOneThatIsAsMapped) {
  // 6 m in all, round and round.
  std::vector<Pose2> poses;
  for (int k = 0; k < 60; ++k) poses.push_back({0.3 * std::cos(0.3 * k), 0.3 * std::sin(0.3 * k), 0.0});
  SlamOptions options;
  options.loops.places_after_m = 8.0;
  EXPECT_EQ(mapped(poses, options)->state().places.matched, 0U);
  options.loops.places_after_m = 0.0;
  EXPECT_GT(mapped(poses, options)->state().places.matched, 10U);
}

}  // namespace
}  // namespace phasescan::loop_closer_test
