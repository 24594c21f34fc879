// What the global matcher is told beside the scans (motion during the turn, a first guess), and what it says of
// corridors and rooms that repeat themselves.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "phasescan/match/scan_matcher.hpp"
#include "sim/pairs_spec.hpp"
#include "support/rooms.hpp"

namespace phasescan::global_motion_test {
namespace {

struct Error {
  double metres, degrees;
};

Error error_of(const Pose2& found, const Pose2& truth) {
  return {translation_distance(found, truth), rad_to_deg(angle_distance(found.theta, truth.theta))};
}

/// A scan whose beams are fired one after the other while the sensor moves: 360 beams, 5.5 turns a second. Truth: the
/// pose at the first beam.
Scan scan_in_motion(const Pose2& start, const Twist2& twist, std::uint64_t seed) {
  constexpr int kBeams = 360;
  const double dt = 1.0 / (5.5 * kBeams);
  Random random(seed);
  std::vector<float> ranges;
  for (int i = 0; i < kBeams; ++i) {
    // One beam of a still scan from where the sensor is by then.
    const Pose2 pose = start * exp_twist(twist, dt * i);
    const Scan beam = test::cast_room({pose.x, pose.y, pose.theta + kTwoPi * i / kBeams}, 1, 0.0);
    const double range = beam.is_hit(0) ? static_cast<double>(beam.ranges[0]) + random.normal(0.0, 0.01) : 0.0;
    ranges.push_back(static_cast<float>(range));
  }
  Scan scan = make_scan(ranges, {-kPi, kTwoPi / kBeams, 0.15, 6.0});
  scan.time_increment = dt;
  return scan;
}

TEST(GlobalMotion, ATwistTakesTheMotionOutOfBothScans) {
  ScanMatcher matcher;
  const Twist2 turning{0.3, 0.0, deg_to_rad(180.0)}, back{0.2, 0.0, deg_to_rad(-180.0)};
  const MatchHints hints{{}, back, turning};
  double with_m = 0.0, with_deg = 0.0, without_m = 0.0, without_deg = 0.0;
  Random random(3);
  constexpr int kPairs = 12;
  for (int k = 0; k < kPairs; ++k) {
    const Pose2 truth{random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-kPi, kPi)};
    const Scan reference = scan_in_motion({}, back, static_cast<std::uint64_t>(2 * k + 1)),
               scan = scan_in_motion(truth, turning, static_cast<std::uint64_t>(2 * k + 2));
    const MatchResult told = matcher.match(reference, scan, hints), not_told = matcher.match(reference, scan);
    const Error with = error_of(told.T_ref_scan, truth), without = error_of(not_told.T_ref_scan, truth);
    EXPECT_LT(with.metres, 0.03) << k;
    EXPECT_LT(with.degrees, 0.6) << k;
    EXPECT_TRUE(told.usable) << k;
    with_m += with.metres / kPairs;
    with_deg += with.degrees / kPairs;
    without_m += without.metres / kPairs;
    without_deg += without.degrees / kPairs;
  }
  EXPECT_GT(without_m, 5.0 * with_m);
  EXPECT_GT(without_deg, 5.0 * with_deg);
}

TEST(GlobalMotion, ATwistOfTheReferenceWorksWithAPreparedOneToo) {
  ScanMatcher matcher;
  const Twist2 turning{0.3, 0.0, deg_to_rad(180.0)};
  const Pose2 truth{0.4, 0.3, 0.8};
  const Scan reference = scan_in_motion({}, turning, 1), scan = test::cast_room(truth, 360, 0.01, 0.0, 2);
  const Pose2 raw = matcher.match(reference, scan, {{}, turning, {}}).T_ref_scan,
              prepared = matcher.match(matcher.prepare(reference, turning), scan).T_ref_scan;
  EXPECT_EQ(raw.x, prepared.x);
  EXPECT_EQ(raw.theta, prepared.theta);
  EXPECT_LT(error_of(raw, truth).metres, 0.03);
}

TEST(GlobalGuess, ARightOneIsFollowedAndAWrongOneNeverBelieved) {
  ScanMatcher matcher;
  Random random(8);
  const Scan reference = test::cast_room({}, 360, 0.01);
  int given_up = 0;
  for (int k = 0; k < 20; ++k) {
    const Pose2 truth{random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-kPi, kPi)};
    const Scan scan = test::cast_room(truth, 360, 0.01, 0.02, static_cast<std::uint64_t>(k + 2));
    const Pose2 near{truth.x + random.uniform(-0.3, 0.3), truth.y + random.uniform(-0.3, 0.3),
                     wrap_angle(truth.theta + random.uniform(-0.4, 0.4))};
    const MatchResult right = matcher.match(reference, scan, {near, {}, {}});
    EXPECT_LT(error_of(right.T_ref_scan, truth).metres, 0.03) << k;
    EXPECT_TRUE(right.usable) << k;
    const Pose2 far{truth.x + 2.0, truth.y - 1.5, wrap_angle(truth.theta + 2.0)};
    const MatchResult wrong = matcher.match(reference, scan, {far, {}, {}});
    EXPECT_TRUE(!wrong.usable || error_of(wrong.T_ref_scan, truth).metres < 0.1) << k << " " << *wrong.confidence;
    given_up += error_of(wrong.T_ref_scan, truth).metres < 0.1;
  }
  EXPECT_GE(given_up, 18) << "a guess that leads nowhere is no worse than none";
}

/// A room of 5 x 3.4 m that looks the same after half a turn.
Scan rectangle(const Pose2& pose, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> ranges;
  for (int k = 0; k < 360; ++k) {
    const double angle = pose.theta + kTwoPi * k / 360, dx = std::cos(angle), dy = std::sin(angle);
    const double to_x = dx == 0.0 ? 1e9 : ((dx > 0.0 ? 2.5 : -2.5) - pose.x) / dx,
                 to_y = dy == 0.0 ? 1e9 : ((dy > 0.0 ? 1.7 : -1.7) - pose.y) / dy;
    ranges.push_back(static_cast<float>(std::min(to_x, to_y) + random.normal(0.0, 0.01)));
  }
  return make_scan(ranges, {0.0, kTwoPi / 360, 0.15, 6.0});
}

TEST(GlobalTwins, TheOneThatTurnedLessComesFirstAndTheAnswerIsAmbiguous) {
  ScanMatcher matcher;
  Random random(5);
  for (std::uint64_t k = 0; k < 20; ++k) {
    const Pose2 T_world_ref{random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(-kPi, kPi)};
    const Pose2 truth{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.6, 0.6)};
    const MatchResult found =
        matcher.match(rectangle(T_world_ref, 2 * k + 1), rectangle(T_world_ref * truth, 2 * k + 2));
    EXPECT_LT(error_of(found.T_ref_scan, truth).metres, 0.05) << k;
    EXPECT_TRUE(found.ambiguous) << k;
    EXPECT_FALSE(found.usable) << k;
  }
}

TEST(GlobalGuess, ItDecidesBetweenTheTwinsOfASymmetricRoom) {
  ScanMatcher matcher;
  const Pose2 T_world_ref{0.6, -0.3, 0.2}, T_world_scan{0.2, 0.4, 0.9};
  const Pose2 truth = T_world_ref.inverse() * T_world_scan,
              twin = T_world_ref.inverse() * Pose2{0.0, 0.0, kPi} * T_world_scan;
  const Scan reference = rectangle(T_world_ref, 1), scan = rectangle(T_world_scan, 2);
  const MatchResult alone = matcher.match(reference, scan);
  EXPECT_TRUE(alone.ambiguous);
  EXPECT_FALSE(alone.usable);
  ASSERT_FALSE(alone.alternatives.empty());
  // Only one of them is right, and which one cannot be known: neither can the heading.
  double sum = *alone.confidence;
  for (const MatchAlternative& other : alone.alternatives) sum += other.confidence;
  EXPECT_LE(sum, 1.0 + 1e-12);
  EXPECT_GT(std::sqrt(alone.covariance(2, 2)), 1.0);
  const bool first = error_of(alone.T_ref_scan, truth).metres < 0.05;
  EXPECT_LT(error_of(first ? alone.T_ref_scan : alone.alternatives[0].T_ref_scan, truth).metres, 0.05);
  EXPECT_LT(error_of(first ? alone.alternatives[0].T_ref_scan : alone.T_ref_scan, twin).metres, 0.05);
  for (const Pose2& pose : {truth, twin}) {
    const MatchResult guessed = matcher.match(reference, scan, {Pose2{pose.x + 0.1, pose.y, pose.theta - 0.1}, {}, {}});
    EXPECT_LT(error_of(guessed.T_ref_scan, pose).metres, 0.05);
  }
}

TEST(GlobalGeometry, MovingTheScanMovesTheAnswerAlike) {
  ScanMatcher matcher;
  const Scan reference = test::cast_room({}, 360, 0.01);
  const Pose2 before{0.3, -0.2, 0.5};
  const Pose2 first = matcher.match(reference, test::cast_room(before, 360, 0.01, 0.0, 2)).T_ref_scan;
  for (const Pose2& step : {Pose2{0.2, 0.1, 0.0}, Pose2{-0.4, 0.3, 1.5}, Pose2{0.0, 0.0, kPi}}) {
    const Pose2 second = matcher.match(reference, test::cast_room(before * step, 360, 0.01, 0.0, 3)).T_ref_scan;
    const Error off = error_of(first.inverse() * second, step);
    EXPECT_LT(off.metres, 0.015);
    EXPECT_LT(off.degrees, 0.3);
  }
}

TEST(GlobalGeometry, TheCovarianceIsWideAlongACorridorAndNarrowAcross) {
  ScanMatcher matcher;
  for (const double heading : {0.0, 0.7}) {
    const auto corridor = [&](double y, double theta, std::uint64_t seed) {
      Random random(seed);
      std::vector<float> ranges;
      for (int k = 0; k < 360; ++k) {
        const double s = std::sin(theta + deg_to_rad(k) - heading);
        const double range = std::abs(s) > 0.17 ? ((s > 0.0 ? 1.0 : -1.0) - y) / s + random.normal(0.0, 0.005) : 0.0;
        ranges.push_back(static_cast<float>(range < 6.0 ? range : 0.0));
      }
      return make_scan(ranges, {0.0, deg_to_rad(1.0), 0.1, 6.0});
    };
    const MatchResult result = matcher.match(corridor(0.0, 0.0, 1), corridor(0.3, 0.2, 2));
    EXPECT_TRUE(result.ambiguous);
    EXPECT_FALSE(result.usable);
    const Eigen::Vector2d along(std::cos(heading), std::sin(heading)), across(-along.y(), along.x());
    const Eigen::Matrix2d C = result.covariance.topLeftCorner<2, 2>();
    EXPECT_GT(along.dot(C * along), 1.0) << heading;
    EXPECT_LT(across.dot(C * across), 1e-3) << heading;
    EXPECT_LE(result.covariance.cwiseAbs().maxCoeff(), 1e6);
    // Turned half way round, a bare corridor looks the same.
    EXPECT_NEAR(std::abs(across.dot(result.T_ref_scan.translation())), 0.3, 0.02);
  }
}

TEST(GlobalGeometry, RoomsThatRepeatThemselvesNeverGiveAConfidentWrongPose) {
  sim::PairsSpec spec = sim::read_pairs_spec("bench-rows");
  std::erase_if(spec.rows, [](const sim::PairRow& row) {
    return row.dataset != "empty-room" && row.dataset != "bare-corridor" && row.dataset != "none";
  });
  ASSERT_EQ(spec.rows.size(), 3u);
  const sim::PairGenerator generator(std::move(spec), 99);
  ScanMatcher matcher;
  int wrong_and_usable = 0, right = 0;
  for (std::uint64_t k = 0; k < 150; ++k) {
    const ScanPair pair = generator.make(k).pair;
    const MatchResult result = matcher.match(pair.reference, pair.scan);
    const bool is_right = pair.truth && error_of(result.T_ref_scan, *pair.truth).metres < 0.1 &&
                          error_of(result.T_ref_scan, *pair.truth).degrees < 3.0;
    wrong_and_usable += result.usable && !is_right;
    right += is_right;
  }
  EXPECT_EQ(wrong_and_usable, 0);
  EXPECT_GT(right, 20) << "a test of nothing if no answer were right";
}

TEST(GlobalGeometry, WhatIsSeenThroughGlassIsNotBelieved) {
  // All walls of glass: now and then a beam meets something, somewhere.
  ScanMatcher matcher;
  const Scan room = test::cast_room({}, 360, 0.01);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const auto glass = [&] {
      std::vector<float> ranges;
      for (int k = 0; k < 360; ++k)
        ranges.push_back(random.chance(0.08) ? static_cast<float>(random.uniform(0.5, 6.0)) : 0.0F);
      return make_scan(ranges, {0.0, kTwoPi / 360, 0.15, 6.0});
    };
    const Scan a = glass(), b = glass();
    EXPECT_FALSE(matcher.match(a, b).usable) << seed;
    EXPECT_FALSE(matcher.match(room, b).usable) << seed;
    EXPECT_FALSE(matcher.match(a, room).usable) << seed;
  }
}

}  // namespace
}  // namespace phasescan::global_motion_test
