// Which keyframes become nodes in bounded memory, decision by decision.
#include <gtest/gtest.h>

#include "odometry/degeneracy.hpp"
#include "slam/bounded_admission.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::admission_test {
namespace {

using testing::add_box;
using testing::drive;
using testing::toy_keyframes;
using testing::ToyLidar;
using testing::two_rooms;
using testing::Wall;

/// A map and what decides about the next keyframe.
struct Admitting {
  SlamOptions options;
  GraphSession session;
  PlaceSearch places;
  BoundedAdmission admission;

  /// @param nodes  the map: all of them become nodes, at their poses
  Admitting(const SlamOptions& o, const std::vector<Keyframe>& nodes)
      : options(o), session(o.loops), places(o.loops), admission(o, {}) {
    for (const Keyframe& keyframe : nodes) insert(keyframe);
  }
  void insert(const Keyframe& keyframe) {
    session.insert_node(keyframe);
    places.add(session.keyframes(), session.poses(), false);
  }
  /// Submits a keyframe and does what is decided then. @return the decisions
  std::vector<Placement> submit(const Keyframe& keyframe) {
    admission.submit(keyframe, session, places);
    return decided();
  }
  std::vector<Placement> close() {
    admission.close();
    return decided();
  }
  std::vector<Placement> decided() {
    std::vector<Placement> out;
    while (std::optional<Placement> placement = admission.next(session)) {
      if (placement->attach_at) {
        session.attach_to_node(placement->keyframe, *placement->attach_at);
      } else {
        insert(placement->keyframe);
      }
      out.push_back(std::move(*placement));
    }
    return out;
  }
};

SlamOptions without_places() {
  SlamOptions options;
  options.loops.places = false;
  return options;
}

/// Keyframes of two rooms at poses, with other noise for another seed.
std::vector<Keyframe> seen_from(const std::vector<Pose2>& poses, std::uint64_t seed, const ToyLidar& lidar = {}) {
  Random random(seed);
  return toy_keyframes(two_rooms(), poses, random, lidar);
}

/// What a crowd around the robot looks like: nothing of the rooms.
Keyframe among_people(const Pose2& pose) {
  std::vector<Wall> people;
  add_box(people, pose.x - 0.7, pose.y - 0.5, pose.x + 0.6, pose.y + 0.8);
  Random random(5);
  Keyframe keyframe = toy_keyframes(people, {pose}, random)[0];
  keyframe.centre.setZero();
  return keyframe;
}

TEST(Admission, APlaceHasAtMostEightKeyframes) {
  for (const int nodes : {7, 8}) {
    auto map = seen_from(std::vector<Pose2>(static_cast<std::size_t>(nodes)), 1);
    for (Keyframe& keyframe : map) keyframe.centre.setZero();
    Admitting run(without_places(), map);
    EXPECT_TRUE(run.submit(among_people({0.1, 0, 0})).empty());
    const auto placed = run.close();
    ASSERT_EQ(placed.size(), 1U);
    ASSERT_EQ(placed[0].attach_at.has_value(), nodes == 8);
    if (nodes < 8) continue;
    EXPECT_EQ(*placed[0].attach_at, (Pose2{0.1, 0, 0}));  // where odometry has it
    EXPECT_FALSE(placed[0].match_information.has_value());
  }
}

TEST(Admission, ALookTheOtherWayIsNewHoweverManyLookedThisWay) {
  ToyLidar half;
  half.field = kPi;
  Admitting run(without_places(), seen_from(std::vector<Pose2>(9), 1, half));
  const auto back = run.submit(seen_from({{0, 0, kPi}}, 2, half)[0]);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_FALSE(back[0].attach_at.has_value());
}

TEST(Admission, AMatchThatMovesFartherThanASmallErrorIsNotBelieved) {
  Keyframe keyframe = seen_from({{0, 0, 0}}, 2)[0];
  keyframe.T_odom_base.x += 0.15;
  for (const double small_error_m : {0.2, 0.1}) {
    SlamOptions options = without_places();
    options.loops.small_error_m = small_error_m;
    Admitting run(options, seen_from(std::vector<Pose2>(3), 1));
    const auto placed = run.submit(keyframe);
    ASSERT_EQ(placed.size(), small_error_m > 0.15 ? 1U : 0U);
    if (!placed.empty()) {
      EXPECT_LT(translation_distance(placed[0].attach_at.value(), {}), 0.01);
    }
  }
}

TEST(Admission, KeyframesThatDoNotFitWaitForEightOthersAtMost) {
  Admitting run(without_places(), seen_from(std::vector<Pose2>(3), 1));
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(run.submit(among_people({})).empty()) << i;
  EXPECT_EQ(run.submit(among_people({})).size(), 9U);
}

TEST(Admission, ASlipIsCorrectedOnceEnoughKeyframesAgree) {
  const auto way = drive({{0, 0}, {2.2, 0}, {0, 0}}, 0.1, 0.2);
  const SlamOptions options;
  Admitting run(options, seen_from(way, 1));
  auto next = seen_from(drive({{0, 0}, {1.5, 0}}, 0.1, 0.2), 2);
  const Pose2 before = run.session.keyframes().back().T_odom_base;
  ASSERT_LT(translation_distance(before, {}), 1e-9);
  // The tracker slips by more than the way since the map was last sure of it explains.
  run.session.confirm_position();
  std::size_t submitted = 0;
  std::vector<Placement> placed;
  while (placed.empty() && submitted < next.size()) {
    Keyframe keyframe = next[submitted++];
    keyframe.T_odom_base = Pose2{0.0, 1.0, 0.0} * keyframe.T_odom_base;
    placed = run.submit(keyframe);
  }
  ASSERT_FALSE(placed.empty());
  ASSERT_EQ(placed.size(), submitted);
  EXPECT_GE(placed.size(), static_cast<std::size_t>(options.loops.votes));
  for (std::size_t i = 0; i < placed.size(); ++i) {
    ASSERT_TRUE(placed[i].attach_at.has_value()) << i;
    EXPECT_LT(translation_distance(*placed[i].attach_at, next[i].T_odom_base), 0.05) << i;
  }
}

TEST(Admission, WhatWasAddedSinceABreakDoesNotShowThatTheRobotIsWhereItWas) {
  const auto left = drive({{-1, 0}, {1, 0}}, 0.1, 0.2);
  Admitting run({}, seen_from(left, 1));
  auto right = seen_from(drive({{5, -1}, {7, -1}, {7, 1}, {5, 0.5}}, 0.1, 0.3), 2);
  right[0].new_segment = true;
  for (const Keyframe& keyframe : right) run.submit(keyframe);
  EXPECT_GT(run.session.keyframes().size(), left.size() + 5);
  EXPECT_GE(run.admission.state().unfit_m, GraphSession::kBreakM);
}

/// What a robot that slipped in a corridor takes for the place that it sees, by a cupboard of some size alone.
std::vector<RelocalisationCandidate> recognised_in_corridor(std::uint64_t seed) {
  Random random(seed);
  const double x = random.uniform(-3.0, 3.0), depth = random.uniform(0.05, 0.3), width = random.uniform(0.1, 1.0);
  std::vector<Wall> walls = {{{-50, -1}, {50, -1}}, {{-50, 1}, {50, 1}}};
  add_box(walls, x, 1.0 - depth, x + width, 1.0);
  Admitting run({}, toy_keyframes(walls, drive({{-1, 0}, {1, 0}}, 0.1, 0.2), random));
  Keyframe next = toy_keyframes(walls, {{0.1, 0.1, 0.1}}, random)[0];
  next.T_odom_base = Pose2{1.5, 0.7, 0.6} * next.T_odom_base;
  run.submit(next);
  return run.admission.state().candidates;
}

TEST(Admission, APlaceIsRecognisedWhereThePoseIsKnownAlongTheCorridorToo) {
  std::size_t recognised = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    for (const RelocalisationCandidate& candidate : recognised_in_corridor(seed)) {
      EXPECT_TRUE(determines_position(candidate.information, 0.11)) << seed;
      EXPECT_LT(translation_distance(candidate.pose, {0.1, 0.1, 0.1}), 0.1) << seed;
      ++recognised;
    }
  }
  EXPECT_GT(recognised, 10U);
}

}  // namespace
}  // namespace phasescan::admission_test
