// What is expected of the motion and what is made of wheels, without scans: maps and points are empty here.
#include "odometry/motion_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "odometry/information.hpp"
#include "scan/surface.hpp"
#include "support/toy_world.hpp"

namespace phasescan::motion_model_test {
namespace {

constexpr double kPeriod = 0.1;

/// Goes straight on, its wheels trusted.
MotionModel driving() {
  MotionModel motion;
  motion.step = {0.05, 0.0, 0.0};
  motion.step_covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  motion.wheels.trust_distance = motion.wheels.trust_turn = 0.95;
  return motion;
}

MotionInput input_of(const std::optional<Pose2>& wheel_step = {}, double periods = 1.0) {
  MotionInput input;
  input.timing.period_s = kPeriod;
  input.timing.periods = periods;
  input.seconds = kPeriod * periods;
  input.wheel_step = wheel_step;
  return input;
}

/// Fuses a step of a match with the standard deviations given.
MotionUpdate fused(MotionModel& motion, const Pose2& moved, const std::optional<Pose2>& wheel_step, double sigma_m,
                   double sigma_rad = 0.05) {
  Registration found;
  found.T_map_base = moved;
  found.information =
      Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m), 1.0 / (sigma_rad * sigma_rad)).asDiagonal();
  found.information /= kMatchTrust;
  PosePrior prior;
  prior.information = 1e-9 * Eigen::Matrix3d::Identity();
  return motion.fuse(found, prior, moved, input_of(wheel_step));
}

TEST(MotionModel, WheelsThatAreTrustedShareInTheStep) {
  MotionModel motion = driving();
  const MotionUpdate update = fused(motion, {0.05, 0.0, 0.0}, Pose2{0.06, 0.0, 0.0}, 0.02);
  EXPECT_GT(update.moved.x, 0.053) << "the match knows less than the wheels";
  EXPECT_LT(update.moved.x, 0.06);
  EXPECT_EQ(update.wheels, WheelConsistency::kAgrees);
  EXPECT_GT(update.known(0, 0), update.seen(0, 0));
  MotionModel sure = driving();
  EXPECT_NEAR(fused(sure, {0.05, 0.0, 0.0}, Pose2{0.06, 0.0, 0.0}, 0.001).moved.x, 0.05, 5e-4);
}

TEST(MotionModel, WheelsThatAreNotTrustedDoNot) {
  for (const bool distance : {true, false}) {
    MotionModel motion = driving();
    (distance ? motion.wheels.trust_distance : motion.wheels.trust_turn) = 0.3;
    EXPECT_EQ(fused(motion, {0.05, 0.0, 0.0}, Pose2{0.06, 0.0, 0.0}, 0.02).moved.x, 0.05);
  }
}

TEST(MotionModel, TheMoreWheelsDifferTheLessTheyWeighAndFarOffNothing) {
  const auto pulled = [](double off) {
    MotionModel motion = driving();
    return (fused(motion, {0.05, 0.0, 0.0}, Pose2{0.05 + off, 0.0, 0.0}, 0.02).moved.x - 0.05) / off;
  };
  EXPECT_GT(pulled(0.002), 0.5);
  EXPECT_LT(pulled(0.04), 0.6 * pulled(0.002));
  EXPECT_EQ(pulled(0.2), 0.0) << "ten standard deviations: wheels that spin";
}

TEST(MotionModel, TheNextStepIsExpectedToBeLikeTheLast) {
  const MotionModel motion = driving();
  const LocalMap map;
  const MapPoints points;
  const OdometryOptions options;
  const auto expected = [&](const MotionInput& input, const SearchPolicy& policy = {}) {
    return motion.predict(map, points, {1.0, 2.0, 0.5 * kPi}, input, policy, false, options);
  };
  const PosePrior once = expected(input_of()).prior;
  EXPECT_NEAR(once.T_map_base.y, 2.05, 1e-9);
  EXPECT_NEAR(expected(input_of({}, 3.0)).prior.T_map_base.y, 2.15, 1e-9) << "two scans are missing";
  EXPECT_NEAR(expected(input_of(Pose2{0.09, 0.0, 0.0})).prior.T_map_base.y, 2.07, 1e-9) << "wheels show a new speed";
  // 2.5 cm and 0.06 rad of change from scan to scan, and what is not known of the last step.
  const Eigen::Matrix3d covariance = (kMatchTrust * once.information).inverse();
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), std::hypot(0.025, 0.01), 1e-6);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), std::hypot(0.06, 0.01), 1e-6);
  EXPECT_NEAR((kMatchTrust * expected(input_of({}, 3.0)).prior.information).inverse()(0, 0), 9.0 * covariance(0, 0),
              1e-9);
  SearchPolicy sparse;
  sparse.change_m = 0.5;
  EXPECT_GT((kMatchTrust * expected(input_of(), sparse).prior.information).inverse()(0, 0), 0.25);
}

TEST(MotionModel, WhatIsKnownOfAStepTurnsWithTheRobot) {
  // Seen across, and not along, the way it looks: on a map where it looks along y.
  MotionModel motion = driving();
  motion.step_covariance = Eigen::Vector3d(0.09, 1e-4, 1e-4).asDiagonal();
  const PosePrior prior =
      motion.predict(LocalMap(), MapPoints(), {0.0, 0.0, 0.5 * kPi}, input_of(), {}, false, {}).prior;
  const Eigen::Matrix3d covariance = (kMatchTrust * prior.information).inverse();
  EXPECT_LT(std::sqrt(covariance(0, 0)), 0.05);
  EXPECT_GT(std::sqrt(covariance(1, 1)), 0.25);
}

TEST(MotionModel, AlongACorridorAStepIsNeverQuiteUnknown) {
  MotionModel motion = driving();
  MotionUpdate update;
  update.moved = {0.05, 0.0, 0.0};
  update.seen = update.known = Eigen::Vector3d(1e-4, 1e6, 1e6).asDiagonal();
  for (int k = 0; k < 5; ++k) motion.correct(update, 0.8, input_of());
  EXPECT_NEAR(std::sqrt(motion.step_covariance(0, 0)), 0.15, 1e-6);
  EXPECT_LT(std::sqrt(motion.step_covariance(1, 1)), 0.01);
}

TEST(MotionModel, WithoutAMatchItSlowsDownAndFollowsTrustedWheels) {
  MotionModel motion = driving();
  const Pose2 predicted{0.05, 0.0, 0.0}, wheels{0.08, 0.0, 0.1};
  EXPECT_EQ(motion.step_without_match(predicted, input_of()).x, 0.05);
  EXPECT_NEAR(motion.step.x, 0.025, 1e-9);
  EXPECT_EQ(motion.step_without_match(predicted, input_of(wheels)).x, 0.08);
  EXPECT_NEAR(motion.step.x, 0.0125, 1e-9);
  EXPECT_GT(motion.step_covariance(0, 0), 1e-3);
  motion.wheels.trust_distance = 0.3;
  EXPECT_EQ(motion.step_without_match(predicted, input_of(wheels)).x, 0.05);
  motion.forget_speed();
  EXPECT_EQ(motion.step.x, 0.0);
  EXPECT_GT(std::sqrt(motion.step_covariance(0, 0)), 0.4) << "it may have been carried, or driven off";
}

TEST(MotionModel, WheelsSayHowAScanTurnsBeforeItIsMatched) {
  MotionModel motion = driving();
  motion.twist = {0.5, 0.0, 0.1};
  ScanTiming timing;
  timing.period_s = kPeriod;
  motion.begin_scan(timing, Pose2{0.0, 0.0, 0.0}, {});
  EXPECT_NEAR(motion.begin_scan(timing, Pose2{0.05, 0.0, 0.08}, {}).twist.omega, 0.8, 1e-9);
  EXPECT_EQ(motion.begin_scan(timing, std::nullopt, {}).twist.omega, 0.1);
  OdometryOptions without;
  without.use_wheels = false;
  motion.begin_scan(timing, Pose2{0.1, 0.0, 0.16}, {});
  EXPECT_EQ(motion.begin_scan(timing, Pose2{0.15, 0.0, 0.24}, without).twist.omega, 0.1);
  motion.wheels.trust_turn = 0.3;
  motion.begin_scan(timing, Pose2{0.2, 0.0, 0.32}, {});
  EXPECT_EQ(motion.begin_scan(timing, Pose2{0.25, 0.0, 0.4}, {}).twist.omega, 0.1) << "not trusted";
}

/// The toy world as a scan at the origin saw it, and what a scan at another pose sees.
struct Seen {
  LocalMap map;
  MapPoints points;
  explicit Seen(const Pose2& T_map_base) {
    map.reset({}, 20.0, 0.1);
    map.add(points_at({}, 1), {});
    map.finish();
    points = points_at(T_map_base, 2);
  }
  static MapPoints points_at(const Pose2& pose, std::uint64_t seed) {
    Random random(seed);
    SurfaceWorkspace work;
    SurfacePoints surface;
    MapPoints points;
    find_surface(testing::toy_scan(testing::two_rooms(), pose, {}, random, {}), {}, work, surface, kTrackingLines);
    to_map_points(surface, {}, 20.0, points);
    return points;
  }
  Pose2 step(const MotionModel& motion, const MotionInput& input) const {
    return motion.predict(map, points, {}, input, {}, false, {}).step;
  }
};

TEST(MotionModel, OfThePossibleStepsTheOneThatExplainsTheScanIsTaken) {
  MotionModel motion = driving();
  motion.usual_score = 0.2;
  motion.step = {0.3, 0.0, 0.0};
  EXPECT_EQ(Seen({0.3, 0.0, 0.0}).step(motion, input_of()).x, 0.3) << "as before";
  EXPECT_EQ(Seen({}).step(motion, input_of()).x, 0.0) << "it stopped";
  EXPECT_EQ(Seen({0.15, 0.0, 0.0}).step(motion, input_of(Pose2{0.15, 0.0, 0.0})).x, 0.15) << "by the wheels";
  EXPECT_EQ(Seen({-0.15, 0.0, 0.0}).step(motion, input_of(Pose2{0.15, 0.0, 0.0})).x, -0.15)
      << "wheels that do not see which way they turn";
  motion.step = {0.1, 0.0, 0.0};
  EXPECT_NEAR(Seen({0.3, 0.0, 0.0}).step(motion, input_of({}, 3.0)).x, 0.3, 1e-9) << "two scans are missing";
}

TEST(MotionModel, TurnsAreTriedWhereNothingElseExplainsTheScan) {
  MotionModel motion = driving();
  motion.step = {};
  const Seen turned({0.0, 0.0, 0.3});
  motion.usual_score = 0.0;
  EXPECT_EQ(turned.step(motion, input_of()).theta, 0.0) << "good enough: scans are usually explained no better";
  motion.usual_score = 0.8;
  EXPECT_NEAR(turned.step(motion, input_of()).theta, 0.3, 1e-9);
}

TEST(MotionModel, AStepOfSeveralStepsSaysHowManyPeriodsPassedWhereStampsDoNot) {
  const MotionModel motion = driving();
  MotionInput input = input_of();
  EXPECT_EQ(motion.with_scans_missing(input, {0.3, 0.0, 0.0}).timing.periods, 1.0) << "stamps are to be trusted";
  input.timing.unsteady = true;
  EXPECT_EQ(motion.with_scans_missing(input, {0.3, 0.0, 0.0}).timing.periods, 6.0);
  EXPECT_NEAR(motion.with_scans_missing(input, {0.3, 0.0, 0.0}).seconds, 6.0 * kPeriod, 1e-12);
  EXPECT_EQ(motion.with_scans_missing(input, {0.09, 0.0, 0.0}).timing.periods, 1.0) << "it speeds up";
  EXPECT_EQ(motion.with_scans_missing(input, {20.0, 0.0, 0.0}).timing.periods, 15.0);
}

TEST(SearchPolicy, SparseLogsAreSearchedWidelyAndLostSooner) {
  MotionVariability dense, sparse;
  dense.set_period(0.1);
  sparse.set_period(1.0);
  const OdometryOptions options;
  const SearchPolicy near = search_policy(dense, options), far = search_policy(sparse, options);
  EXPECT_TRUE(near.fuse_last_scan && near.resolve_degenerate && near.filter_free_standing);
  EXPECT_FALSE(near.always_try_last_scan || near.try_doubtful_last_scan);
  EXPECT_EQ(near.lost_after_scans, options.lost_after_scans);
  EXPECT_TRUE(far.always_try_last_scan && far.try_doubtful_last_scan);
  EXPECT_FALSE(far.fuse_last_scan || far.resolve_degenerate || far.filter_free_standing);
  EXPECT_LT(far.lost_after_scans, near.lost_after_scans);
  EXPECT_GE(far.change_m, 0.5);
  EXPECT_LT(far.last_scan_gain, near.last_scan_gain) << "there it may be a little worse";
}

TEST(SearchPolicy, AfterLostScansTheMatchWithoutAGuessCountsWithinWhatRobotsCanDo) {
  MotionVariability dense;
  dense.set_period(0.1);
  const OdometryOptions options;
  const auto lost = [](double seconds) { return ScanTiming{.periods = 10.0 * seconds, .period_s = 0.1}; };
  const SearchPolicy usual = search_policy(dense, options), one = search_policy(dense, options, lost(1.0)),
                     two = search_policy(dense, options, lost(1.5));
  EXPECT_FALSE(usual.must_explain || usual.scans_missing);
  EXPECT_TRUE(one.always_try_last_scan && one.try_doubtful_last_scan && one.fuse_last_scan);
  EXPECT_TRUE(one.must_explain && one.scans_missing);
  EXPECT_GT(one.alone_share, 0.5);
  EXPECT_LT(one.alone_share, 1.0);
  EXPECT_GT(two.most_doubtful_turn, one.most_doubtful_turn);
  EXPECT_GT(two.most_doubtful_m, one.most_doubtful_m);
  EXPECT_LT(two.most_doubtful_turn, 4.0);
}

TEST(SearchPolicy, WhereStampsCannotTellLossesTheMatchWithoutAGuessIsAskedAfterALongStep) {
  MotionVariability dense;
  dense.set_period(0.1);
  const OdometryOptions options;
  const SearchPolicy next = search_policy(dense, options, ScanTiming{.period_s = 0.1, .unsteady = true});
  EXPECT_TRUE(next.scans_missing);
  EXPECT_FALSE(next.always_try_last_scan || next.must_explain);
  const SearchPolicy later =
      search_policy(dense, options, ScanTiming{.period_s = 0.1, .unsure_s = 1.0, .unsteady = true});
  EXPECT_TRUE(later.scans_missing && later.always_try_last_scan && later.try_doubtful_last_scan);
  EXPECT_FALSE(later.must_explain) << "nobody knows that scans are missing";
  EXPECT_GT(later.alone_share, 1.0) << "however well the map explains the scan: along a corridor it explains many";
  EXPECT_GT(later.most_doubtful_m, next.most_doubtful_m);
}

}  // namespace
}  // namespace phasescan::motion_model_test
