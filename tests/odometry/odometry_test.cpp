// What the public class says of each scan: status, pose, covariance.
#include "phasescan/odometry/odometry.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "support/toy_logs.hpp"

namespace phasescan::odometry_test {
namespace {

using testing::toy_scan;
using testing::ToyLidar;
using testing::ToyLog;

bool is_covariance(const Eigen::Matrix3d& m) {
  return m.allFinite() && m == m.transpose() && m.llt().info() == Eigen::Success;
}

TEST(Odometry, EveryCovarianceIsSymmetricAndPositiveDefinite) {
  for (const ToyLog& log : testing::toy_logs(200)) {
    Odometry odometry;
    for (const RangeMeasurement& m : log.measurements) {
      const OdometryUpdate update = odometry.add(m);
      ASSERT_TRUE(is_covariance(update.covariance)) << log.name << "\n" << update.covariance;
      EXPECT_EQ(update.stamp, m.scan.stamp);
    }
  }
}

TEST(Odometry, TheCovarianceGrowsWithTheWay) {
  // Straight on: on the way back errors of the heading cancel.
  const ToyLog log = testing::corridor_log(240);
  Odometry odometry;
  double before = 0.0;
  for (std::size_t i = 0; i < log.measurements.size(); ++i) {
    const OdometryUpdate update = odometry.add(log.measurements[i]);
    const double position = update.covariance(0, 0) + update.covariance(1, 1);
    if (i % 60 != 59) continue;
    EXPECT_GT(position, 1.3 * before) << i;
    before = position;
  }
  EXPECT_GT(std::sqrt(before), 0.05);
}

TEST(Odometry, WhatIsNotSeenIsUncertainAlongTheCorridorOnly) {
  const std::vector<testing::Wall> bare = {{{-30, -0.9}, {60, -0.9}}, {{-30, 0.9}, {60, 0.9}}};
  const ToyLidar lidar{.beams = 180, .range_max = 5.0, .field = kPi};
  Random random(2);
  Odometry odometry;
  OdometryUpdate update;
  for (int i = 0; i < 80; ++i)
    update = odometry.add({toy_scan(bare, {0.05 * i, 0, 0}, lidar, random, stamp_from_seconds(0.1 * i))});
  EXPECT_EQ(update.status, TrackingStatus::kAmbiguous);
  EXPECT_GT(std::sqrt(update.covariance(0, 0)), 0.6);
  EXPECT_LT(update.covariance(1, 1), 0.15 * update.covariance(0, 0));
}

TEST(Odometry, ErrorsAreOfTheSizeThatTheCovarianceSays) {
  // Mean of e^T P^-1 e / 3 over tours with other noise each: 1 for a covariance that is exactly right, less for one
  // that is wider. Measured 0.004 to 0.6: wheels that are right make it narrower than it says.
  for (const auto make :
       {testing::turning_lidar_log, testing::wheels_log, testing::two_lasers_log, testing::corridor_log}) {
    double sum = 0.0;
    int count = 0;
    std::string name;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const ToyLog log = make(300, seed);
      name = log.name;
      Odometry odometry;
      for (std::size_t i = 0; i < log.measurements.size(); ++i) {
        const OdometryUpdate update = odometry.add(log.measurements[i]);
        if (i % 50 != 49) continue;
        const Pose2 truth = log.truth[0].inverse() * log.truth[i];
        const Pose2& found = update.T_odom_base;
        const Eigen::Vector3d e(found.x - truth.x, found.y - truth.y, wrap_angle(found.theta - truth.theta));
        sum += e.dot(update.covariance.inverse() * e) / 3.0;
        ++count;
      }
    }
    EXPECT_LT(sum / count, 2.0) << name;
    EXPECT_GT(sum / count, 0.001) << name;
  }
}

TEST(Odometry, StatusSaysHowAScanWasFound) {
  std::map<TrackingStatus, std::size_t> seen;
  std::size_t segments = 0, searched = 0;
  for (const ToyLog& log : testing::toy_logs(200)) {
    Odometry odometry;
    for (const RangeMeasurement& m : log.measurements) {
      const OdometryUpdate update = odometry.add(m);
      ++seen[update.status];
      segments += update.diagnostics.new_segment;
      searched += update.diagnostics.wide_search;
      EXPECT_FALSE(update.status == TrackingStatus::kOk && update.diagnostics.wide_search);
      EXPECT_TRUE(!update.diagnostics.new_segment || update.status == TrackingStatus::kLost);
      EXPECT_TRUE(m.scan.hit_count() > 0 || !is_tracked(update.status));
    }
  }
  for (const TrackingStatus status : {TrackingStatus::kInitialising, TrackingStatus::kOk, TrackingStatus::kDegraded,
                                      TrackingStatus::kAmbiguous, TrackingStatus::kLost}) {
    EXPECT_GT(seen[status], 0u) << to_string(status);
  }
  EXPECT_GT(segments, 0u);
  EXPECT_GT(searched, 0u);
}

TEST(Odometry, ScansBeforeTheFirstReturnsAreTheOrigin) {
  Odometry odometry;
  Random random(1);
  const OdometryUpdate empty = odometry.add({});
  EXPECT_EQ(empty.status, TrackingStatus::kInitialising);
  EXPECT_EQ(empty.T_odom_base, Pose2{});
  EXPECT_TRUE(is_covariance(empty.covariance));
  const OdometryUpdate first = odometry.add({toy_scan(testing::two_rooms(), {}, {}, random, 1)});
  EXPECT_EQ(first.status, TrackingStatus::kOk);
  EXPECT_TRUE(first.keyframe);
  EXPECT_EQ(first.T_odom_base, Pose2{});
}

TEST(Odometry, RefusesOptionsOutOfBounds) {
  OdometryOptions options;
  options.min_overlap = 2.0;
  EXPECT_THROW(Odometry{options}, std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::odometry_test
