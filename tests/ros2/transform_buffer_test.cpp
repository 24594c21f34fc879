// Transforms at a time: against straight computation, and what is not there.
#include "ros2/transform_buffer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ros2/node_support.hpp"

namespace phasescan::ros2::transform_buffer_test {
namespace {

/// A frame that turns and moves: pose in its parent at a time.
Pose3 moving(double t, int k) {
  Pose3 pose;
  pose.translation = {std::sin(t + k), 0.3 * t * k, std::cos(2.0 * t)};
  pose.rotation = Eigen::AngleAxisd(0.7 * t + k, Eigen::Vector3d(1.0, k, 2.0).normalized());
  return pose;
}

TransformStamped stamped(Stamp stamp, const std::string& parent, const std::string& child, const Pose3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& p = pose.translation;
  return {{stamp, parent}, child, {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}}};
}

void expect_same(const Pose3& a, const Pose3& b, double tolerance) {
  EXPECT_LT((a.translation - b.translation).norm(), tolerance);
  EXPECT_LT(a.rotation.angularDistance(b.rotation), tolerance);
}

/// a <- b <- c, and d hangs on a too.
TransformBuffer tree(double until_s, double step_s) {
  TransformBuffer buffer;
  for (double t = 0.0; t <= until_s + 1e-9; t += step_s) {
    buffer.add({{stamped(at(t), "a", "b", moving(t, 1)), stamped(at(t), "b", "c", moving(t, 2)),
                 stamped(at(t), "a", "/d", moving(t, 3))}},
               false);
  }
  return buffer;
}

TEST(TransformBuffer, AtStampsItIsTheProductOfTheSteps) {
  const TransformBuffer buffer = tree(2.0, 0.25);
  for (double t = 0.0; t <= 2.0; t += 0.25) {
    const Pose3 want = inverse(moving(t, 3)) * (moving(t, 1) * moving(t, 2));
    const TransformLookup got = buffer.find("d", "c", at(t));
    ASSERT_EQ(got.found, TransformFound::kFound);
    expect_same(got.pose, want, 1e-9);
    expect_same(buffer.find("c", "/d", at(t)).pose, inverse(want), 1e-9);
  }
  expect_same(buffer.find("b", "b", at(77.0)).pose, Pose3{}, 1e-12);
}

TEST(TransformBuffer, BetweenStampsItIsInterpolated) {
  // Halving the step of a smooth motion must divide the error by about four: so it is no neighbour's value.
  double errors[2];
  for (int i = 0; i < 2; ++i) {
    const double step = i == 0 ? 0.2 : 0.1;
    const TransformBuffer buffer = tree(4.0, step);
    errors[i] = 0.0;
    for (double t = 0.4; t < 3.0; t += 0.0371) {
      const TransformLookup got = buffer.find("a", "b", at(t));
      ASSERT_EQ(got.found, TransformFound::kFound);
      errors[i] = std::max(errors[i], (got.pose.translation - moving(t, 1).translation).norm());
    }
  }
  EXPECT_LT(errors[1], 0.35 * errors[0]);
  EXPECT_LT(errors[0], 0.02);
}

TEST(TransformBuffer, NothingBeyondTheEnds) {
  const TransformBuffer buffer = tree(2.0, 0.25);
  EXPECT_EQ(buffer.find("a", "c", at(2.01)).found, TransformFound::kTooLate);
  EXPECT_EQ(buffer.find("a", "c", at(-0.01)).found, TransformFound::kTooEarly);
  EXPECT_EQ(buffer.find("a", "x", at(1.0)).found, TransformFound::kUnknownFrame);
  EXPECT_EQ(buffer.find("a", "x", at(1.0)).where, "x");
  EXPECT_EQ(buffer.find_newest("a", "c").found, TransformFound::kFound);
}

TEST(TransformBuffer, AWayThatMeetsBelowWhatIsMissingIsFound) {
  TransformBuffer buffer = tree(2.0, 0.25);
  buffer.add({{stamped(at(9.0), "world", "a", Pose3{})}}, false);  // reaches no time below 9 s
  EXPECT_EQ(buffer.find("b", "c", at(1.0)).found, TransformFound::kFound);
  EXPECT_EQ(buffer.find("world", "c", at(1.0)).found, TransformFound::kTooEarly);
  EXPECT_EQ(buffer.find("world", "c", at(1.0)).where, "a");
  buffer.add({{stamped(at(1.0), "p", "q", Pose3{})}}, false);
  EXPECT_EQ(buffer.find("q", "c", at(1.0)).found, TransformFound::kNotConnected);
}

TEST(TransformBuffer, StaticOnesHoldAtAllTimes) {
  TransformBuffer buffer;
  buffer.add({{stamped(at(5.0), "base", "laser", moving(1.0, 1))}}, true);
  expect_same(buffer.find("base", "laser", at(-1e5)).pose, moving(1.0, 1), 1e-12);
  buffer.forget_after(at(0.0));
  EXPECT_EQ(buffer.find("base", "laser", at(1e5)).found, TransformFound::kFound);
}

TEST(TransformBuffer, OutOfOrderAndTwiceTheSame) {
  TransformBuffer buffer;
  for (const double t : {1.0, 0.5, 0.75, 0.5}) buffer.add({{stamped(at(t), "a", "b", moving(t, 1))}}, false);
  expect_same(buffer.find("a", "b", at(0.75)).pose, moving(0.75, 1), 1e-12);
  EXPECT_EQ(buffer.find("a", "b", at(0.49)).found, TransformFound::kTooEarly);
}

TEST(TransformBuffer, AClockThatIsSetBackBeginsAnew) {
  TransformBuffer buffer = tree(60.0, 0.25);
  buffer.add({{stamped(at(0.5), "a", "b", moving(0.5, 1))}}, false);
  EXPECT_EQ(buffer.find("a", "b", at(0.5)).found, TransformFound::kFound);
  EXPECT_EQ(buffer.find("a", "b", at(59.0)).found, TransformFound::kTooLate);
  EXPECT_EQ(buffer.find("b", "c", at(59.0)).found, TransformFound::kFound);
  buffer.forget_after(at(1.0));
  EXPECT_NE(buffer.find("b", "c", at(59.0)).found, TransformFound::kFound);
}

TEST(TransformBuffer, KeepsWhatItSaysAndNoMore) {
  TransformBuffer buffer(2'000'000'000);
  for (double t = 0.0; t < 10.0; t += 0.1) buffer.add({{stamped(at(t), "a", "b", Pose3{})}}, false);
  EXPECT_EQ(buffer.find("a", "b", at(5.0)).found, TransformFound::kTooEarly);
  EXPECT_EQ(buffer.find("a", "b", at(8.5)).found, TransformFound::kFound);
  for (int i = 0; i < 5000; ++i) buffer.add({{stamped(at(0.0), "a", "f" + std::to_string(i), Pose3{})}}, false);
  EXPECT_TRUE(buffer.is_known("f10"));
  EXPECT_FALSE(buffer.is_known("f4999"));
}

TEST(TransformBuffer, WhatIsNoTransformIsLeftOut) {
  TransformBuffer buffer;
  TransformStamped bad = stamped(at(0.0), "a", "b", Pose3{});
  bad.transform.translation.y = std::nan("");
  TransformStamped zero = stamped(at(0.0), "a", "b", Pose3{});
  zero.transform.rotation = {0, 0, 0, 0};
  const TransformStamped self = stamped(at(0.0), "a", "/a", Pose3{}), nameless = stamped(at(0.0), "", "b", Pose3{});
  EXPECT_EQ(buffer.add({{bad, zero, self, nameless}}, false), 4U);
  EXPECT_FALSE(buffer.is_known("b"));
  // A circle ends.
  buffer.add({{stamped(at(0.0), "a", "b", Pose3{}), stamped(at(0.0), "b", "a", Pose3{})}}, true);
  EXPECT_EQ(buffer.find("a", "c", at(0.0)).found, TransformFound::kUnknownFrame);
  EXPECT_EQ(buffer.find("a", "b", at(0.0)).found, TransformFound::kFound);
}

}  // namespace
}  // namespace phasescan::ros2::transform_buffer_test
