#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "phasescan/match/scan_matcher.hpp"
#include "support/rooms.hpp"

namespace phasescan::global_test {
namespace {

void expect_near(const Pose2& found, const Pose2& truth, double metres, double degrees) {
  EXPECT_LT(translation_distance(found, truth), metres)
      << found.x << " " << found.y << " for " << truth.x << " " << truth.y;
  EXPECT_LT(angle_distance(found.theta, truth.theta), deg_to_rad(degrees)) << found.theta << " for " << truth.theta;
}

std::vector<Pose2> some_poses() {
  Random random(11);
  std::vector<Pose2> poses;
  for (int k = 0; k < 12; ++k)
    poses.push_back({random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-kPi, kPi)});
  return poses;
}

TEST(Global, FindsAnyRotationWithoutAGuess) {
  ScanMatcher matcher;
  const Scan reference = test::cast_room({}, 360, 0.01, 0.02);
  for (const Pose2& truth : some_poses()) {
    const MatchResult result = matcher.match(reference, test::cast_room(truth, 360, 0.01, 0.02, 5));
    expect_near(result.T_ref_scan, truth, 0.02, 0.5);
    EXPECT_TRUE(result.usable) << *result.confidence;
  }
}

TEST(Global, TheInverseMatchGivesTheInversePose) {
  ScanMatcher matcher;
  const Scan a = test::cast_room({}, 360, 0.01);
  for (const Pose2& truth : some_poses()) {
    const Scan b = test::cast_room(truth, 360, 0.01, 0.0, 6);
    expect_near(matcher.match(b, a).T_ref_scan.inverse(), matcher.match(a, b).T_ref_scan, 0.01, 0.2);
  }
}

TEST(Global, TurningTheScansFrameTurnsTheAnswer) {
  ScanMatcher matcher;
  const Scan reference = test::cast_room({}, 360, 0.01);
  const Scan scan = test::cast_room({0.4, -0.3, 0.7}, 360, 0.01, 0.0, 6);
  const Pose2 plain = matcher.match(reference, scan).T_ref_scan;
  for (const double turn : {0.3, 1.9, -2.6}) {
    Scan turned = scan;
    turned.geometry.angle_min += turn;
    expect_near(matcher.match(reference, turned).T_ref_scan, plain * Pose2{0, 0, -turn}, 0.01, 0.2);
  }
}

TEST(Global, TheOrderOfTheBeamsDoesNotMatter) {
  ScanMatcher matcher;
  const Scan reference = test::cast_room({}, 360, 0.01);
  const Scan scan = test::cast_room({0.4, -0.3, 0.7}, 360, 0.01, 0.0, 6);
  std::vector<float> ranges, angles;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const std::size_t k = i * 7 % scan.size();
    ranges.push_back(raw_range(scan, k));
    angles.push_back(static_cast<float>(scan.angle(k)));
  }
  const Scan permuted = make_scan(ranges, {0.0, 0.0, scan.geometry.range_min, scan.geometry.range_max}, angles);
  expect_near(matcher.match(reference, permuted).T_ref_scan, matcher.match(reference, scan).T_ref_scan, 1e-3, 0.02);
}

TEST(Global, ClockwiseAndCoarseSensorsAreMatchedAlike) {
  ScanMatcher matcher;
  const Pose2 truth{0.3, 0.4, -1.1};
  const Scan reference = test::cast_room({}, 720, 0.01);
  for (const int beams : {90, 180, 1000, 4000}) {
    const Scan scan = test::cast_room(truth, beams, 0.01, 0.02, 9, 6.0, 0.4, true);
    expect_near(matcher.match(reference, scan).T_ref_scan, truth, 0.03, 1.0);
  }
}

TEST(Global, PreparedReferencesAndThreadsDoNotChangeTheAnswer) {
  ScanMatcher matcher;
  const Scan reference = test::cast_room({}, 360, 0.01);
  std::vector<Scan> scans;
  for (const Pose2& pose : some_poses()) scans.push_back(test::cast_room(pose, 360, 0.01, 0.02, 4));
  const auto one = match_many(reference, scans, MatchOptions{}, 1),
             three = match_many(reference, scans, MatchOptions{}, 3);
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const MatchResult raw = matcher.match(reference, scans[k]);
    for (const MatchResult* other : {&one[k], &three[k]}) {
      EXPECT_EQ(raw.T_ref_scan.x, other->T_ref_scan.x);
      EXPECT_EQ(raw.T_ref_scan.y, other->T_ref_scan.y);
      EXPECT_EQ(raw.T_ref_scan.theta, other->T_ref_scan.theta);
      EXPECT_EQ(*raw.confidence, *other->confidence);
      EXPECT_EQ(raw.covariance, other->covariance);
    }
  }
}

Scan scan_of(double (*range)(double angle), int beams = 360, double range_max = 6.0) {
  std::vector<float> ranges;
  for (int k = 0; k < beams; ++k) ranges.push_back(static_cast<float>(range(kTwoPi * k / beams)));
  return make_scan(ranges, {0.0, kTwoPi / beams, 0.1, range_max});
}

TEST(Global, AScanWithFewerHitsThanAskedForIsNotMatched) {
  const Scan room = test::cast_room({}, 360, 0.01);
  for (const int hits : {9, 10}) {
    std::vector<float> ranges;
    for (int k = 0; k < 360; ++k) ranges.push_back(k < hits ? raw_range(room, static_cast<std::size_t>(k)) : 0.0F);
    const Scan few = make_scan(ranges, room.geometry);
    ASSERT_EQ(few.hit_count(), static_cast<std::size_t>(hits));
    for (const auto& [reference, scan] : {std::pair{room, few}, std::pair{few, room}})
      EXPECT_EQ(match_scans(reference, scan).status == MatchStatus::kNoPoints, hits < 10);
  }
}

TEST(Global, HopelessScansAreNeverUsable) {
  ScanMatcher matcher;
  const Scan room = test::cast_room({}, 360, 0.01);
  const std::vector<Scan> hopeless{
      make_scan({}, {}),
      scan_of([](double) { return 0.0; }),
      scan_of([](double) { return static_cast<double>(std::numeric_limits<float>::quiet_NaN()); }),
      scan_of([](double angle) { return angle < 0.01 ? 2.0 : 0.0; }),
      scan_of([](double) { return 2.0; }),                                                           // a circle
      scan_of([](double angle) { return std::min(1.0 / std::max(std::cos(angle), 0.01), 100.0); }),  // one wall
      scan_of(
          [](double angle) { return std::min(1.0 / std::max(std::abs(std::cos(angle)), 0.01), 100.0); }),  // a corridor
      scan_of([](double angle) {
        return std::min(1.0 / std::max(std::abs(std::cos(angle)), 1e-9),
                        1.0 / std::max(std::abs(std::sin(angle)), 1e-9));
      })};  // a square
  for (std::size_t k = 0; k < hopeless.size(); ++k) {
    for (const auto& [reference, scan] :
         {std::pair{room, hopeless[k]}, std::pair{hopeless[k], room}, std::pair{hopeless[k], hopeless[k]}}) {
      const MatchResult result = matcher.match(reference, scan);
      EXPECT_FALSE(result.usable) << k << ", confidence " << result.confidence.value_or(-1);
      EXPECT_TRUE(result.T_ref_scan.is_finite());
      EXPECT_TRUE(result.covariance.allFinite());
      ASSERT_TRUE(result.confidence.has_value());
      EXPECT_GE(*result.confidence, 0.0);
      EXPECT_LE(*result.confidence, 1.0);
    }
  }
}

}  // namespace
}  // namespace phasescan::global_test
