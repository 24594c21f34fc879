// Places found by what they look like: views of keyframes, and loops that the map itself does not suggest.
#include <gtest/gtest.h>

#include <cmath>

#include "slam/backend.hpp"
#include "slam/place_search.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::places_test {
namespace {

using testing::add_box;
using testing::drive;
using testing::toy_keyframes;
using testing::ToyLidar;
using testing::Wall;

/// A way round a block of 20 x 14 m, with things along its walls.
std::vector<Wall> ring_world() {
  std::vector<Wall> walls;
  add_box(walls, 0, 0, 20, 14);
  add_box(walls, 3, 3, 17, 11);
  Random random(8);
  for (int i = 0; i < 9; ++i) {
    const double x = random.uniform(2.5, 17.0), y = random.uniform(3.0, 10.5), w = random.uniform(0.3, 1.2);
    if (i % 3 != 0) {
      add_box(walls, x, i % 2 ? 0.0 : 13.6, x + w, i % 2 ? 0.5 : 14.0);
    } else {
      add_box(walls, i % 2 ? 0.0 : 19.5, y, i % 2 ? 0.5 : 20.0, y + w);
    }
  }
  return walls;
}

/// Keyframes at the poses, with an odometry that turns `bias` too far for each metre, and says how little it knows of
/// its heading where it does.
std::vector<Keyframe> keyframes_at(const std::vector<Wall>& walls, const std::vector<Pose2>& poses, double bias) {
  ToyLidar lidar;
  lidar.range_max = 7.0;
  Random random(4);
  std::vector<Pose2> T_odom = {poses[0]};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Pose2 step = poses[i - 1].inverse() * poses[i];
    T_odom.push_back(T_odom.back() * step * Pose2{0.0, 0.0, bias * std::hypot(step.x, step.y)});
  }
  auto keyframes = toy_keyframes(walls, poses, random, lidar, [&](std::size_t i) { return T_odom[i]; });
  for (Keyframe& keyframe : keyframes) {
    if (bias > 0.0) keyframe.information(2, 2) = 60.0;
  }
  return keyframes;
}

struct Outcome {
  double worst_m = 0.0;    ///< of all keyframes
  double closing_m = 0.0;  ///< of the last keyframe as the one seen nearest to it on the first lap sees it
  LoopCounts loops;
};

Outcome map_of(const SlamOptions& options, const std::vector<Keyframe>& keyframes, const std::vector<Pose2>& truth) {
  Backend backend(options);
  for (std::size_t from = 0; from < keyframes.size(); from += 10) {
    const std::size_t to = std::min(keyframes.size(), from + 10);
    backend.add_batch(
        {keyframes.begin() + static_cast<std::ptrdiff_t>(from), keyframes.begin() + static_cast<std::ptrdiff_t>(to)});
  }
  backend.finish();
  Outcome out;
  out.loops = backend.loop_counts();
  for (std::size_t i = 0; i < truth.size(); ++i)
    out.worst_m = std::max(out.worst_m, translation_distance(backend.poses()[i], truth[i]));
  std::size_t first = 0;
  for (std::size_t i = 0; i < truth.size() / 2; ++i) {
    if (translation_distance(truth[i], truth.back()) < translation_distance(truth[first], truth.back())) first = i;
  }
  const Pose2 estimated = backend.poses()[first].inverse() * backend.poses().back();
  out.closing_m = translation_distance(estimated, truth[first].inverse() * truth.back());
  return out;
}

TEST(Places, ATourThatDriftsByMetresClosesByWhatItsStartLooksLike) {
  const auto walls = ring_world();
  const auto tour = drive({{1.5, 1.5}, {18.5, 1.5}, {18.5, 12.5}, {1.5, 12.5}, {1.5, 1.5}, {14.0, 1.5}}, 0.3, 0.3);
  const auto keyframes = keyframes_at(walls, tour, 0.02);
  ASSERT_GT(translation_distance(keyframes.back().T_odom_base, tour.back()), 4.0);
  SlamOptions options;
  options.loops.places = false;
  const Outcome near_only = map_of(options, keyframes, tour);
  EXPECT_GT(near_only.closing_m, 1.0);
  options.loops.places = true;
  const Outcome with_places = map_of(options, keyframes, tour);
  EXPECT_GT(with_places.loops.places, 2U);
  EXPECT_LT(with_places.closing_m, 0.1);
}

/// Two rooms that are the same to the millimetre, 12 m apart, and a passage between them.
std::vector<Wall> twin_rooms() {
  std::vector<Wall> walls;
  for (const double x : {0.0, 12.0}) {
    const auto add = [&](double x1, double y1, double x2, double y2) { walls.push_back({{x + x1, y1}, {x + x2, y2}}); };
    add(0, 0, 6, 0), add(0, 0, 0, 2.5), add(0, 3.7, 0, 5), add(0, 5, 6, 5), add(6, 0, 6, 2.5), add(6, 3.7, 6, 5);
    add(1.0, 0, 1.0, 0.6), add(1.0, 0.6, 2.3, 0.6), add(2.3, 0.6, 2.3, 0), add(4.5, 5, 5.4, 4.1), add(5.4, 4.1, 6, 4.1);
  }
  walls.push_back({{6, 2.5}, {12, 2.5}});
  walls.push_back({{6, 3.7}, {12, 3.7}});
  return walls;
}

TEST(Places, RoomsThatLookAlikeAreNotTakenForOne) {
  const auto walls = twin_rooms();
  std::vector<Eigen::Vector2d> stops;
  for (const double x : {0.0, 12.0, 0.0, 12.0}) {
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(3, 3), Eigen::Vector2d(1.5, 2), Eigen::Vector2d(3.5, 1.2),
                                     Eigen::Vector2d(4.2, 3.2), Eigen::Vector2d(2.0, 3.8), Eigen::Vector2d(4.5, 3.1)})
      stops.emplace_back(p.x() + x, p.y());
  }
  const auto tour = drive(stops, 0.3, 0.3);
  const auto keyframes = keyframes_at(walls, tour, 0.0);
  SlamOptions options;
  options.loops.places_after_m = 0.0;
  const Outcome gated = map_of(options, keyframes, tour);
  EXPECT_LT(gated.worst_m, 0.05);
  // Whatever may come by the gate is outvoted, or taken out again because the way between the rooms contradicts it.
  options.loops.most_drift = 10.0;
  const Outcome open = map_of(options, keyframes, tour);
  EXPECT_GT(open.loops.places, gated.loops.places);
  EXPECT_LT(open.worst_m, 0.05);
}

TEST(Places, AViewIsMadeOfTheNearestHitsOfSeveralKeyframes) {
  const auto walls = testing::two_rooms();
  std::vector<Pose2> poses = {{0, 0, 0}, {0.3, 0, 0}};
  auto keyframes = keyframes_at(walls, poses, 0.0);
  const Scan one = view_at(keyframes, poses, 1, 0), both = view_at(keyframes, poses, 1, 5);
  ASSERT_EQ(one.size(), 360U);
  EXPECT_GE(both.hit_count(), one.hit_count());
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (!one.is_hit(i)) continue;
    ASSERT_TRUE(both.is_hit(i));
    EXPECT_LE(both.ranges[i], one.ranges[i]);
    EXPECT_NEAR(both.ranges[i], testing::toy_range(walls, {0.3, 0.0}, both.angle(i)), 0.5) << i;
  }
  keyframes[1].new_segment = true;
  EXPECT_EQ(view_at(keyframes, poses, 1, 5).hit_count(), one.hit_count());
}

TEST(Places, AViewSeesWhatKeyframesBeforeItLookedAt) {
  const std::vector<Pose2> poses = {{0, 0, 0}, {0, 0, kPi}};
  ToyLidar half;
  half.field = kPi;
  Random random(4);
  const auto keyframes = toy_keyframes(testing::two_rooms(), poses, random, half);
  EXPECT_GT(view_at(keyframes, poses, 1, 1).hit_count(), view_at(keyframes, poses, 1, 0).hit_count() * 3 / 2);
}

/// What a search finds from each of the keyframes, taken in one after the other.
std::vector<std::vector<PlaceMatch>> searched(const std::vector<Keyframe>& keyframes, const std::vector<Pose2>& poses,
                                              const LoopOptions& options) {
  PlaceSearch places(options);
  std::vector<std::vector<PlaceMatch>> found;
  for (std::size_t n = 1; n <= keyframes.size(); ++n)
    found.push_back(places.add({keyframes.data(), n}, {poses.data(), n}, true));
  return found;
}

TEST(Places, WhatLiesJustBehindIsNoPlaceSeenBefore) {
  const auto poses = drive({{0, 0}, {1.2, 0}, {0, 0}, {1.2, 0}}, 0.1, 0.3);
  const auto keyframes = keyframes_at(testing::two_rooms(), poses, 0.0);
  const LoopOptions options;
  const auto found = searched(keyframes, poses, options);
  std::size_t all = 0;
  for (std::size_t node = 0; node < found.size(); ++node) {
    for (const PlaceMatch& match : found[node]) EXPECT_LE(match.node, static_cast<int>(node) - options.min_nodes_apart);
    all += found[node].size();
  }
  EXPECT_GT(all, 2U);
}

}  // namespace
}  // namespace phasescan::places_test
