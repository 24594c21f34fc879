// The last pass over all scans, on a map made of keyframes whose poses are exact.
#include "slam/trajectory_refinement.hpp"

#include <gtest/gtest.h>

#include "slam/scan_ledger.hpp"
#include "support/toy_keyframes.hpp"

namespace phasescan::trajectory_refinement_test {
namespace {

using testing::corridor_with_niches;
using testing::toy_keyframes;
using testing::toy_scan;
using testing::ToyLidar;
using testing::two_rooms;

constexpr double kPeriodS = 0.1;

/// Scans around a keyframe at the origin, one a tenth of a second.
struct ScansAround {
  Backend backend{SlamOptions{}};
  ScanStore scans;
  std::vector<ScanRecord> records;

  ScansAround() {
    Random random(3);
    backend.add_batch(toy_keyframes(two_rooms(), {{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}}, random));
  }
  void add(const Pose2& pose, const Twist2& twist, double turn_s) {
    Random random(7 + records.size());
    ToyLidar lidar;
    lidar.turn_s = turn_s;
    const Stamp stamp = stamp_from_seconds(1.0 + kPeriodS * static_cast<double>(records.size()));
    scans.add(toy_scan(two_rooms(), pose, lidar, random, stamp, twist), {});
    ScanRecord record;
    record.stamp = stamp;
    record.keyframe = 0;
    records.push_back(record);
  }
  std::vector<Pose2> refined(const std::vector<Pose2>& guess) const {
    ScanLedger ledger;
    ledger.records = records;
    return refine_trajectory(backend, scans, guess, ledger, {}, {});
  }
};

TEST(TrajectoryRefinement, APoseIsMovedByCentimetresOrNotAtAll) {
  ScansAround run;
  std::vector<Pose2> guess;
  for (const double off : {0.0, 0.05, 0.1, 0.18}) {
    run.add({0, 0, 0}, {}, 0.0);
    guess.push_back({off, 0, 0});
  }
  const std::vector<Pose2> poses = run.refined(guess);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(translation_distance(poses[i], {}), 0.01) << i;
  EXPECT_EQ(poses[3], guess[3]);
}

TEST(TrajectoryRefinement, MotionOfATurnIsThatBeforeItsStampWhereBeamsAreListedLastToFirst) {
  ScansAround run;
  std::vector<Pose2> truth;
  constexpr double kRadS = 0.8;
  // Turns, then stands: the motion after the last turn says nothing of what distorted it.
  constexpr int kLastTurn = 10;
  for (int i = 0; i < 14; ++i) {
    truth.push_back({0, 0, kRadS * kPeriodS * (std::min(i, kLastTurn) - kLastTurn)});
    run.add(truth.back(), {0, 0, i <= kLastTurn ? kRadS : 0.0}, -0.9 * kPeriodS);
  }
  const std::vector<Pose2> poses = run.refined(truth);
  for (int i = 5; i < 14; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_LT(std::abs(wrap_angle(poses[k].theta - truth[k].theta)), 0.01) << i;
  }
}

TEST(TrajectoryRefinement, LostScansAreLedBackFromWhereTrackingFoundItsWayAgain) {
  ScansAround run;
  std::vector<Pose2> truth, guess;
  for (int i = 0; i < 12; ++i) {
    truth.push_back({0.05 * i, 0.01 * i, 0.02 * i});
    if (i >= 8) truth.back().theta += 0.9;  // it turned while no scan came
    run.add(truth.back(), {}, 0.0);
    const bool lost = i >= 4 && i < 8;
    run.records.back().status = lost ? TrackingStatus::kLost : TrackingStatus::kOk;
    guess.push_back(lost ? truth[3] * Pose2{-0.2, 0.1, -0.3} : truth.back());
  }
  const std::vector<Pose2> poses = run.refined(guess);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_LT(translation_distance(poses[i], truth[i]), 0.02) << i;
    EXPECT_LT(angle_distance(poses[i].theta, truth[i].theta), 0.01) << i;
  }
  // Tracking began anew elsewhere, and nothing ties that to the map before.
  Random random(4);
  auto elsewhere = toy_keyframes(corridor_with_niches(9, 0.5), {{4, 0, 0}}, random);
  elsewhere[0].new_segment = true;
  run.backend.add_batch(std::move(elsewhere));
  for (std::size_t i = 8; i < 12; ++i) run.records[i].keyframe = 3;
  EXPECT_EQ(run.refined(guess)[7], guess[7]) << "another piece has no way back";
}

}  // namespace
}  // namespace phasescan::trajectory_refinement_test
