// Places that repeat: what tracking and earlier loops leave open between two nodes, and loops that ask for more.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/random.hpp"
#include "slam/backend.hpp"
#include "slam/path_covariance.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::repeating_places_test {
namespace {

using testing::add_box;
using testing::drive;
using testing::toy_keyframes;
using testing::ToyLidar;
using testing::Wall;

GraphSession driven(const std::vector<Pose2>& poses, const Eigen::Matrix3d& information) {
  GraphSession session((LoopOptions()));
  for (const Pose2& pose : poses) {
    Keyframe keyframe;
    keyframe.T_odom_base = pose;
    keyframe.information = information;
    session.insert_node(std::move(keyframe));
  }
  return session;
}

Loop small_loop(int from, int to, const Pose2& T_from_to) {
  Loop loop;
  loop.from = from;
  loop.to = to;
  loop.T_from_to = T_from_to;
  loop.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
  return loop;
}

const std::vector<Pose2>& round_tour() {
  static const std::vector<Pose2> poses = drive({{0, 0}, {12, 0}, {12, 9}, {0, 9}, {0, 0.5}, {6, 0.5}}, 0.3, 0.3);
  return poses;
}

TEST(PathCovariance, IsThatOfStepsWhoseErrorsAddUp) {
  const std::vector<Pose2>& poses = round_tour();
  PathCovariance path;
  path.rebuild(driven(poses, Eigen::Vector3d(400.0, 900.0, 1e4).asDiagonal()));
  const int from = 20, to = static_cast<int>(poses.size()) - 1;
  // What a single step is held to, and what all of them have in common, from two nodes that follow each other.
  const Eigen::Matrix3d step = path.between(from, from + 1);
  const Eigen::LLT<Eigen::Matrix3d> root(step);
  Random random(3);
  Eigen::Matrix3d drawn = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 4000;
  for (int draw = 0; draw < kDraws; ++draw) {
    Pose2 off = poses[from];
    for (int k = from; k < to; ++k) {
      const auto a = static_cast<std::size_t>(k);
      const Eigen::Vector3d e = root.matrixL() * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
      off = off * (poses[a].inverse() * poses[a + 1]) * Pose2{e.x(), e.y(), e.z()};
    }
    const Pose2 error = poses[static_cast<std::size_t>(to)].inverse() * off;
    const Eigen::Vector3d e(error.x, error.y, error.theta);
    drawn += e * e.transpose() / kDraws;
  }
  const Eigen::Matrix3d said = path.between(from, to);
  // On top of single errors comes a turn that all steps have in common: some tenths of a degree on so short a way.
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(std::sqrt(said(i, i)), 0.9 * std::sqrt(drawn(i, i))) << i;
    EXPECT_LT(std::sqrt(said(i, i)), 1.6 * std::sqrt(drawn(i, i))) << i;
  }
}

TEST(PathCovariance, GrowsWithTheWayAndIsNothingWithinANode) {
  PathCovariance path;
  path.rebuild(driven(round_tour(), Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal()));
  EXPECT_LT(path.between(7, 7).cwiseAbs().maxCoeff(), 1e-12);
  double last = 0.0;
  for (int to = 20; to < static_cast<int>(round_tour().size()); to += 20) {
    const double here = path.between(0, to).topLeftCorner<2, 2>().trace() + path.between(0, to)(2, 2);
    EXPECT_GT(path.between(0, to)(2, 2), last);
    EXPECT_GT(here, 0.0);
    last = path.between(0, to)(2, 2);
  }
}

TEST(PathCovariance, ALoopMakesItSmallAndAsOneGoesAsWhenTakenAsAWhole) {
  GraphSession session = driven(round_tour(), Eigen::Vector3d(100.0, 100.0, 1000.0).asDiagonal());
  const int last = session.last_node();
  const Pose2 between = session.poses().front().inverse() * session.poses().back();
  PathCovariance step_by_step;
  step_by_step.rebuild(session);
  const double open = step_by_step.between(0, last)(2, 2);
  session.add_loop(small_loop(0, last, between));
  step_by_step.append(session);
  PathCovariance at_once;
  at_once.rebuild(session);
  EXPECT_LT(step_by_step.between(0, last)(2, 2), 0.1 * open);
  EXPECT_LT((step_by_step.between(0, last) - at_once.between(0, last)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(step_by_step.between(10, last)(2, 2), step_by_step.between(last, 10)(2, 2), 1e-12);
}

TEST(PathCovariance, NothingIsKnownAcrossABreak) {
  GraphSession session((LoopOptions()));
  for (int k = 0; k < 4; ++k) {
    Keyframe keyframe;
    keyframe.T_odom_base = {0.3 * k, 0.0, 0.0};
    keyframe.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
    keyframe.new_segment = k == 2;
    session.insert_node(std::move(keyframe));
  }
  PathCovariance path;
  path.rebuild(session);
  EXPECT_LT(path.between(0, 1)(0, 0), 0.01);
  EXPECT_GT(path.between(0, 3)(0, 0), 4.0);
}

TEST(PathCovariance, SeenFromANodeWhatIsAheadIsKnownAsWellAsWhatLiesBehind) {
  const std::vector<Pose2> poses = drive({{0, 0}, {12, 0}}, 0.3, 0.3);
  const GraphSession session = driven(poses, Eigen::Vector3d(400.0, 900.0, 1e4).asDiagonal());
  PathCovariance path;
  path.rebuild(session);
  const std::vector<double> sigmas = position_sigmas(session, 20);
  ASSERT_EQ(sigmas.size(), poses.size());
  EXPECT_EQ(sigmas[20], 0.0);
  EXPECT_NEAR(sigmas[32], std::sqrt(path.between(20, 32).topLeftCorner<2, 2>().trace()), 1e-9);
  EXPECT_GT(sigmas[32], sigmas[26]);
  EXPECT_NEAR(sigmas[8], sigmas[32], 0.1 * sigmas[32]);
}

TEST(PathCovariance, ALoopThatIsFoundLateMakesKnownWhatLiesBeforeIt) {
  GraphSession session((LoopOptions()));
  for (int k = 0; k < 30; ++k) {
    Keyframe keyframe;
    keyframe.T_odom_base = {0.3 * k, 0.0, 0.0};
    keyframe.information = Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal();
    keyframe.new_segment = k == 10;
    session.insert_node(std::move(keyframe));
  }
  EXPECT_GT(position_sigmas(session, 2)[12], 3.0) << "nothing is known across the break";
  session.add_loop(small_loop(2, 29, {8.1, 0.0, 0.0}));
  EXPECT_LT(position_sigmas(session, 2)[12], 0.2);
  PathCovariance forward;
  forward.rebuild(session);
  EXPECT_GT(std::sqrt(forward.between(2, 12)(0, 0)), 3.0) << "what is taken in order cannot know it";
}

/// A hall with a pillar every 4 m: from where no wall is in reach all places look the same.
std::vector<Wall> pillar_hall() {
  std::vector<Wall> walls;
  add_box(walls, 0, 0, 36, 20);
  for (int x = 4; x < 36; x += 4) {
    for (int y = 4; y < 20; y += 4) add_box(walls, x - 0.2, y - 0.2, x + 0.2, y + 0.2);
  }
  return walls;
}

TEST(RepeatingPlaces, PillarsThatAreAllAlikeDoNotMoveTheMap) {
  const auto tour = drive({{2, 2}, {34, 2}, {34, 6}, {2, 6}, {2, 10}, {34, 10}, {34, 14}, {2, 14}}, 0.4, 0.3);
  ToyLidar lidar;
  lidar.range_max = 9.0;
  Random random(4);
  const auto keyframes = toy_keyframes(pillar_hall(), tour, random, lidar);
  Backend backend((SlamOptions()));
  for (const Keyframe& keyframe : keyframes) backend.add_batch({keyframe});
  backend.finish();
  const LoopCounts loops = backend.loop_counts();
  EXPECT_GT(loops.places, 20U) << "they do look alike";
  EXPECT_GT(loops.rejected_beyond_drift + loops.rejected_alike, 10U);
  // The first place that looks like another one cannot be seen before there are two pillars behind the robot.
  EXPECT_GT(backend.doubted_node(), 8);
  EXPECT_LT(backend.doubted_node(), static_cast<int>(tour.size()));
  double worst = 0.0;
  for (std::size_t k = 0; k < tour.size(); ++k)
    worst = std::max(worst, translation_distance(backend.poses()[k], tour[k]));
  EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace phasescan::repeating_places_test
