// How wheel odometry is judged, step by step, without scans.
#include "odometry/wheel_monitor.hpp"

#include <gtest/gtest.h>

namespace phasescan::wheel_monitor_test {
namespace {

constexpr double kHeardFrom = 0.6;  // trust from which the motion model hears the wheels
const Pose2 kStep{0.2, 0.0, 0.1};

/// Steps of one kind until the trust is on the other side of what is heard; at most 100.
template <class Crossed>
int steps_until(WheelOdometryMonitor& wheels, const Pose2& told, Crossed&& crossed) {
  int steps = 0;
  while (steps < 100 && !crossed()) wheels.judge(told, kStep), ++steps;
  return steps;
}

TEST(WheelMonitor, TrustIsLostAndWonWithinAFewSteps) {
  for (const bool distance : {true, false}) {
    WheelOdometryMonitor wheels;
    const auto heard = [&] { return (distance ? wheels.trust_distance : wheels.trust_turn) >= kHeardFrom; };
    for (int k = 0; k < 50; ++k) EXPECT_EQ(wheels.judge(kStep, kStep), WheelConsistency::kAgrees);
    ASSERT_TRUE(heard());
    const Pose2 wrong = distance ? Pose2{0.5, 0.0, 0.1} : Pose2{0.2, 0.0, 0.5};
    const int lost = steps_until(wheels, wrong, [&] { return !heard(); });
    EXPECT_GE(lost, 2) << "one slip says little";
    EXPECT_LE(lost, 8);
    for (int k = 0; k < 50; ++k) wheels.judge(wrong, kStep);
    const int won = steps_until(wheels, kStep, heard);
    EXPECT_GE(won, 3) << "one step may agree by chance";
    EXPECT_LE(won, 10);
  }
}

TEST(WheelMonitor, StepsOffByLittleAgreeAndOthersDoNot) {
  WheelOdometryMonitor wheels;
  EXPECT_EQ(wheels.judge({0.02, 0.0, 0.02}, {}), WheelConsistency::kAgrees);
  EXPECT_EQ(wheels.judge({0.06, 0.0, 0.0}, {}), WheelConsistency::kSlips);
  EXPECT_EQ(wheels.judge({1.2, 0.0, 0.0}, {1.0, 0.0, 0.0}), WheelConsistency::kAgrees);
  EXPECT_EQ(wheels.judge({1.4, 0.0, 0.0}, {1.0, 0.0, 0.0}), WheelConsistency::kSlips);
  EXPECT_EQ(wheels.judge({0.2, 0.0, 0.6}, {0.2, 0.0, 0.1}), WheelConsistency::kSlips);
  EXPECT_EQ(wheels.judge({-0.2, 0.0, 0.1}, {0.2, 0.0, 0.1}), WheelConsistency::kReversed);
  EXPECT_EQ(wheels.judge({-0.2, 0.0, 0.6}, {0.2, 0.0, 0.1}), WheelConsistency::kSlips) << "turns have no sign to lose";
  EXPECT_EQ(wheels.counts.steps, 7u);
  EXPECT_EQ(wheels.counts.agreed, 2u);
  EXPECT_EQ(wheels.counts.reversed, 1u);
  EXPECT_EQ(wheels.counts.slipped, 4u);
}

TEST(WheelMonitor, WhatTheScansDidNotSeeIsNotJudged) {
  // Along a bare corridor the match says nothing of the distance: wheels that differ from it there lose no trust.
  const Eigen::Matrix2d along = Eigen::Vector2d(100.0, 0.0).asDiagonal();
  WheelOdometryMonitor wheels, seen;
  const double before = wheels.trust_distance;
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(wheels.judge({0.5, 0.0, 0.1}, kStep, along), WheelConsistency::kAgrees);
    seen.judge({0.5, 0.0, 0.1}, kStep);
  }
  EXPECT_NEAR(wheels.trust_distance, before, 0.01) << "nor do they gain any";
  EXPECT_LT(seen.trust_distance, 0.1);
}

TEST(WheelMonitor, AJumpIsNoStepAndCostsTrust) {
  WheelOdometryMonitor wheels;
  EXPECT_FALSE(wheels.step(Pose2{}));
  ASSERT_TRUE(wheels.step(Pose2{0.5, 0.0, 0.0}));
  const double before = wheels.trust_distance;
  EXPECT_FALSE(wheels.step(Pose2{4.0, 0.0, 0.0}));
  EXPECT_EQ(wheels.counts.jumped, 1u);
  EXPECT_LT(wheels.trust_distance, 0.6 * before);
  EXPECT_LT(wheels.trust_turn, 0.6 * before);
  const std::optional<Pose2> next = wheels.step(Pose2{4.1, 0.0, 0.0});
  ASSERT_TRUE(next);
  EXPECT_NEAR(next->x, 0.1, 1e-12) << "steps go on from where the jump ended";
  EXPECT_FALSE(wheels.step(std::nullopt));
  EXPECT_FALSE(wheels.step(Pose2{4.2, 0.0, 0.0})) << "nothing to compare with";
}

}  // namespace
}  // namespace phasescan::wheel_monitor_test
