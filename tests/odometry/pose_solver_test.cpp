// How a pose is looked for on a local map: what is a partner, what is taken instead of what was found, and when the
// match against the last scan is asked for.
#include "odometry/pose_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "odometry/frame.hpp"
#include "support/toy_world.hpp"

namespace phasescan::pose_solver_test {
namespace {

using testing::Wall;

MapPoints seen(const std::vector<Wall>& walls, const Pose2& pose, std::uint64_t seed, double noise = 0.005,
               double map_range_m = 30.0) {
  Random random(seed);
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(testing::toy_scan(walls, pose, {.beams = 360, .range_max = 8.0, .noise = noise}, random, 0), {}, work,
               surface, kTrackingLines);
  MapPoints points;
  to_map_points(surface, {}, map_range_m, points);
  return points;
}

LocalMap map_of(const std::vector<Wall>& walls, const std::vector<Pose2>& poses) {
  LocalMap map;
  map.reset({}, 20.0, 0.1);
  std::uint64_t seed = 1;
  for (const Pose2& pose : poses) map.add(seen(walls, pose, seed++), pose);
  map.finish();
  return map;
}

PoseSolution solve(const LocalMap& map, const MapPoints& points, const Pose2& guess, const SearchPolicy& policy = {},
                   const std::optional<LastScanMatch>& last = {}, int* asked = nullptr) {
  PoseQuery query;
  query.guess = query.prior.T_map_base = guess;
  query.prior.information = Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal();
  query.usual_score = 0.8;
  query.match_last_scan = [&] {
    if (asked != nullptr) ++*asked;
    return last;
  };
  return solve_pose(map, points, query, policy);
}

const Pose2 kTruth{0.6, -0.3, 0.4};

TEST(PoseSolver, AScanThatIsExplainedAsUsualIsNotMatchedWithTheLastOne) {
  const LocalMap map = map_of(testing::two_rooms(), {{}, {0.5, 0.0, 0.2}});
  int asked = 0;
  const PoseSolution found = solve(map, seen(testing::two_rooms(), kTruth, 9), {0.65, -0.28, 0.42}, {}, {}, &asked);
  EXPECT_LT(translation_distance(found.found.T_map_base, kTruth), 0.02);
  EXPECT_EQ(asked, 0);
}

TEST(PoseSolver, FarFromWhatIsExpectedTheMatchAgainstTheLastScanIsFollowed) {
  const LocalMap map = map_of(testing::two_rooms(), {{}, {0.5, 0.0, 0.2}});
  const LastScanMatch last{{0.62, -0.29, 0.41}, 1e-4 * Eigen::Matrix3d::Identity(), true, false};
  const PoseSolution found = solve(map, seen(testing::two_rooms(), kTruth, 9), {-1.2, 1.0, 2.4}, {}, last);
  EXPECT_TRUE(found.full_search);
  EXPECT_LT(translation_distance(found.found.T_map_base, kTruth), 0.02);
}

TEST(PoseSolver, AMatchInDoubtIsNotFollowedHalfATurnAway) {
  // A room that looks the same after half a turn, and an expectation that explains little.
  const std::vector<Wall> room = {{{-4, -2}, {4, -2}}, {{4, -2}, {4, 2}}, {{4, 2}, {-4, 2}}, {{-4, 2}, {-4, -2}}};
  const LocalMap map = map_of(room, {{}, {0.5, 0.3, 0.2}});
  const Pose2 truth{1.5, 0.6, 0.1}, alias = Pose2{0.0, 0.0, kPi} * truth;
  SearchPolicy sparse;
  sparse.try_doubtful_last_scan = sparse.always_try_last_scan = true;
  for (const bool turned : {true, false}) {
    const LastScanMatch last{turned ? alias : truth, 1e-4 * Eigen::Matrix3d::Identity(), false, false};
    const PoseSolution found = solve(map, seen(room, truth, 9), {-0.6, -0.9, 0.7}, sparse, last);
    EXPECT_EQ(found.full_search, !turned);
    EXPECT_LT(angle_distance(found.found.T_map_base.theta, 0.1), 1.3);
  }
}

TEST(PoseSolver, WhatIsFoundNearbyMustBeClearlyBetter) {
  // Asked to be explained better than it can be: the search nearby finds the same place again, and the pose stays.
  const LocalMap map = map_of(testing::two_rooms(), {{}, {0.5, 0.0, 0.2}});
  const MapPoints points = seen(testing::two_rooms(), kTruth, 9, 0.02);
  PoseQuery query;
  query.guess = query.prior.T_map_base = {0.65, -0.28, 0.42};
  query.prior.information = Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal();
  query.usual_score = 2.0;
  query.match_last_scan = [] { return std::nullopt; };
  const PoseSolution found = solve_pose(map, points, query, {});
  const Registration alone = register_points(map, points, query.guess, {}, query.prior);
  EXPECT_TRUE(found.wide_search);
  EXPECT_EQ(found.found.T_map_base.x, alone.T_map_base.x);
  EXPECT_EQ(found.found.T_map_base.theta, alone.T_map_base.theta);
}

const std::vector<Wall> kBareWalls = {{{-50, -1}, {50, -1}}, {{-50, 1}, {50, 1}}};

TEST(PoseSolver, AlongACorridorWhatWasLearnedOfTheMotionDecides) {
  const LocalMap map = map_of(kBareWalls, {{}, {0.5, 0.0, 0.0}});
  PoseQuery query;
  query.guess = query.prior.T_map_base = {0.3, 0.0, 0.0};
  query.prior.information = Eigen::Vector3d(100.0, 100.0, 100.0).asDiagonal();
  query.learned = query.prior;
  query.learned->T_map_base.x = 0.5;
  query.usual_score = 0.8;
  query.match_last_scan = [] { return std::nullopt; };
  SearchPolicy policy;
  policy.resolve_degenerate = false;
  const PoseSolution found = solve_pose(map, seen(kBareWalls, {0.5, 0.0, 0.0}, 9), query, policy);
  EXPECT_NEAR(found.found.T_map_base.x, 0.5, 0.05);
}

TEST(Lattice, OfPosesThatExplainAsMuchTheNearestWins) {
  const LocalMap map = map_of(kBareWalls, {{}, {0.5, 0.0, 0.0}});
  LatticeSearch lattice;
  lattice.points = 360;
  const Pose2 found = search_lattice(map, seen(kBareWalls, {0.5, 0.0, 0.0}, 9), {0.5, 0.0, 0.0}, lattice);
  EXPECT_NEAR(found.x, 0.5, 0.21);
  EXPECT_NEAR(found.y, 0.0, 1e-9);
}

TEST(Registration, FewPartnersDetermineNothing) {
  // Of a wall 1 m ahead 4 hits, and then 5, seen 3 cm off.
  const LocalMap map = map_of({{{1, -2}, {1, 2}}}, {{}});
  const MapPoints all = seen({{{1, -2}, {1, 2}}}, {}, 9, 0.0);
  for (const std::size_t hits : {4U, 5U}) {
    MapPoints few;
    for (std::size_t k = 0; k < hits; ++k) few.append(all, all.size() / 2 + k);
    ASSERT_EQ(few.with_normal, hits);
    const Pose2 found = register_points(map, few, {0.03, 0.0, 0.0}).T_map_base;
    EXPECT_EQ(found.x == 0.03, hits == 4) << found.x;
  }
}

TEST(Registration, HitsWithoutALineTurnThePoseTheRightWay) {
  // A short wall, and thin poles all around that hold the heading.
  std::vector<Wall> world = {{{1.0, -0.3}, {1.0, 0.3}}};
  for (int k = 1; k < 12; ++k) {
    const double angle = 0.55 * k, x = 3.0 * std::cos(angle), y = 3.0 * std::sin(angle);
    testing::add_box(world, x - 0.03, y - 0.03, x + 0.03, y + 0.03);
  }
  const LocalMap map = map_of(world, {{}});
  const MapPoints points = seen(world, {}, 9, 0.0);
  ASSERT_GT(points.size(), points.with_normal + 10);
  for (const double off : {0.03, -0.03}) {
    const Registration found = register_points(map, points, {0.0, 0.0, off});
    EXPECT_NEAR(found.T_map_base.theta, 0.0, 0.004);
  }
}

TEST(MapPoints, HitsBeyondTheMapsRangeAreLeftOut) {
  const MapPoints near = seen(testing::two_rooms(), {}, 1, 0.0, 3.0), all = seen(testing::two_rooms(), {}, 1, 0.0);
  EXPECT_LT(near.size(), all.size());
  EXPECT_GT(near.size(), 50U);
  for (std::size_t k = 0; k < near.size(); ++k) EXPECT_LT(std::hypot(near.x[k], near.y[k]), 3.01F);
}

TEST(Frame, AScanThatIsMostlyMovingObjectsIsMatchedWithThem) {
  RangeMeasurement measurement;
  measurement.scan = make_scan(std::vector<float>(10, 2.0F), {0.0, 0.1, 0.1, 6.0});
  auto points = std::make_shared<MapPoints>();
  points->x.resize(10);
  Frame frame;
  frame.all_points = points;
  frame.left_out = {3, 4, 5};
  EXPECT_EQ(without_moving_objects(measurement, frame).scan.hit_count(), 7U);
  frame.left_out = {3, 4, 5, 6};
  EXPECT_EQ(without_moving_objects(measurement, frame).scan.hit_count(), 10U);
}

/// How many hits of a scan at the origin are left out for a map of the same world; all within 0.4 m of `at` are said to
/// stand free.
std::size_t left_out(const LocalMap& map, const std::vector<Wall>& world, const Eigen::Vector2d& at) {
  auto points = std::make_shared<MapPoints>(seen(world, {}, 9));
  Frame frame;
  for (std::size_t k = 0; k < points->size(); ++k) {
    const Eigen::Vector2f hit(points->x[k], points->y[k]);
    points->free_standing[k] = (hit.cast<double>() - at).norm() < 0.4;
    frame.beams.push_back(static_cast<int>(k));
  }
  frame.all_points = points;
  FrameWorkspace work;
  select_static_points(map, {}, work, frame);
  EXPECT_EQ(frame.points->size() + frame.left_out.size(), points->size());
  return frame.left_out.size();
}

TEST(Frame, WhatStandsFreeIsLeftOutUnlessTheMapHasItOrItIsOnAWall) {
  const std::vector<Wall> room = testing::two_rooms();
  std::vector<Wall> with_pillar = room;
  testing::add_box(with_pillar, 0.9, 0.9, 1.1, 1.1);
  const Eigen::Vector2d pillar(1.0, 1.0);
  const LocalMap empty_room = map_of(room, {{}, {0.6, 0.0, 0.1}, {-0.8, -0.6, 0.2}}),
                 has_it = map_of(with_pillar, {{}, {0.6, 0.0, 0.1}, {-0.8, -0.6, 0.2}, {1.6, -0.4, 0.3}});
  EXPECT_GT(left_out(empty_room, with_pillar, pillar), 4U) << "it may be somebody";
  EXPECT_EQ(left_out(has_it, with_pillar, pillar), 0U) << "static, as the map's scans showed";
  EXPECT_LT(left_out(empty_room, room, {-3.0, 0.0}), 2U) << "a piece of a wall";
}

}  // namespace
}  // namespace phasescan::pose_solver_test
