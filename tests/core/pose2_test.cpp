#include "phasescan/core/pose2.hpp"

#include <gtest/gtest.h>

#include "core/random.hpp"

namespace phasescan::pose2_test {
namespace {

Pose2 random_pose(Random& random) {
  return {random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-kPi, kPi)};
}

void expect_same(const Pose2& a, const Pose2& b, double tolerance = 1e-9) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_LT(angle_distance(a.theta, b.theta), tolerance);
}

TEST(Pose2, ComposedWithItsInverseIsIdentity) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose2 p = random_pose(random);
    expect_same(p * p.inverse(), Pose2{});
    expect_same(p.inverse() * p, Pose2{});
  }
}

TEST(Pose2, CompositionActsLikeItsParts) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Pose2 a = random_pose(random), b = random_pose(random);
    const Eigen::Vector2d p(random.uniform(-3, 3), random.uniform(-3, 3));
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-9);
  }
}

TEST(Pose2, LogIsTheInverseOfExpAlsoNearZero) {
  Random random(3);
  for (const double scale : {1e-9, 1e-5, 1e-2, 1.0, 3.0}) {
    for (int i = 0; i < 50; ++i) {
      const Twist2 twist{random.uniform(-1, 1), random.uniform(-1, 1), scale * random.uniform(-1, 1)};
      const Twist2 back = log_pose(exp_twist(twist));
      EXPECT_NEAR(back.vx, twist.vx, 1e-9);
      EXPECT_NEAR(back.vy, twist.vy, 1e-9);
      EXPECT_NEAR(back.omega, twist.omega, 1e-9);
    }
  }
}

TEST(Pose2, CovarianceOfTheInverseUsesTheJacobianOfTheInverse) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Pose2 p = random_pose(random);
    Eigen::Matrix3d jacobian;
    const double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      Pose2 plus = p, minus = p;
      (k == 0 ? plus.x : k == 1 ? plus.y : plus.theta) += h;
      (k == 0 ? minus.x : k == 1 ? minus.y : minus.theta) -= h;
      const Pose2 a = plus.inverse(), b = minus.inverse();
      jacobian.col(k) << (a.x - b.x) / (2 * h), (a.y - b.y) / (2 * h), wrap_angle(a.theta - b.theta) / (2 * h);
    }
    Eigen::Matrix3d c = Eigen::Matrix3d::Random();
    c = (c * c.transpose()).eval();
    EXPECT_LT((invert_covariance(p, c) - jacobian * c * jacobian.transpose()).norm(), 1e-6 * (1 + c.norm()) * 30);
  }
}

TEST(Angle, WrapsIntoTheHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(kPi), kPi);
  EXPECT_NEAR(wrap_angle(7 * kPi / 2), -kPi / 2, 1e-12);
  EXPECT_NEAR(angle_distance(deg_to_rad(179), deg_to_rad(-179)), deg_to_rad(2), 1e-12);
}

}  // namespace
}  // namespace phasescan::pose2_test
