#include "odometry/degeneracy.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan::degeneracy_test {
namespace {

TEST(Degeneracy, ABoundShrinksOnlyWhatIsLarger) {
  Eigen::Matrix3d covariance;
  covariance << 1.0, 0.9, 0.05, 0.9, 1.0, 0.04, 0.05, 0.04, 0.01;
  const Eigen::Matrix3d before = covariance;
  bound_translation(covariance, 2.0);
  EXPECT_EQ(covariance, before);
  bound_translation(covariance, 0.5);
  EXPECT_NEAR(largest_deviation(covariance.inverse()), 0.5, 1e-3);
  EXPECT_NEAR(covariance(0, 0) - covariance(0, 1), 0.1, 1e-9);  // across, 0.32 m as before
  EXPECT_EQ(covariance(2, 2), 0.01);
  EXPECT_GT(covariance.determinant(), 0.0);
}

TEST(Degeneracy, WhatNothingTellsIsLargeAndFinite) {
  EXPECT_NEAR(largest_deviation(Eigen::Matrix3d::Zero()), 30.0, 2.0);
  // A wall along x: 3 x 3 of rank 2, which has no inverse.
  EXPECT_NEAR(largest_deviation(Eigen::Vector3d(0.0, 1e6, 1e6).asDiagonal()), 30.0, 2.0);
}

TEST(Degeneracy, TheWeakestDirectionIsThatOfTheLeastInformation) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const Eigen::Vector2d weak(0.6, 0.8), strong(-0.8, 0.6);
  information.topLeftCorner<2, 2>() = 1e6 * strong * strong.transpose() + 10.0 * weak * weak.transpose();
  information(2, 2) = 1e6;
  const Eigen::Vector3d u = weakest_direction(information).direction;
  EXPECT_NEAR(std::abs(u.head<2>().dot(weak)), 1.0, 1e-6);
  EXPECT_NEAR(u.z(), 0.0, 1e-6);
}

TEST(Degeneracy, APositionIsDeterminedWhereItsWeakestDirectionIs) {
  Eigen::Matrix3d information = Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal();
  EXPECT_TRUE(determines_position(information));
  information(1, 1) = 1.0 / (0.25 * 0.25);
  EXPECT_FALSE(determines_position(information));
  EXPECT_TRUE(determines_position(information, 0.3));
  EXPECT_FALSE(determines_position(Eigen::Matrix3d::Zero()));
}

TEST(Degeneracy, AStepThatIsNotSeenIsUncertainByAMetreAlongIt) {
  // Walls along x, the base turned by a quarter: the open direction is y of the new base, x of the old one.
  Eigen::Matrix3d seen = Eigen::Matrix3d::Zero();
  seen(0, 0) = 1e6, seen(2, 2) = 1e6;
  const Eigen::Matrix2d covariance = step_covariance_of(seen, 0.5 * kPi);
  EXPECT_NEAR(covariance(0, 0), 1.0, 1e-3);
  EXPECT_LT(covariance(1, 1), 1e-5);
}

}  // namespace
}  // namespace phasescan::degeneracy_test
