// What a run says of itself: numbers, a probability, reasons.
#include "slam/verdict.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "phasescan/slam/slam.hpp"
#include "support/toy_logs.hpp"

namespace phasescan::verdict_test {
namespace {

/// Of a run in which nothing is odd.
RunEvidence faultless() {
  RunEvidence e;
  e.scans = 500, e.keyframes = 100, e.way_m = 40.0, e.duration_s = 100.0;
  e.on_map = 1.0, e.pieces = 1.0, e.loops_per_keyframe = 1.0, e.overlap = 0.95;
  e.expected_m = 0.02, e.expected_ratio = 0.05, e.jump = 1.2, e.turn_jump = 1.2;
  return e;
}

std::vector<RunFinding> findings_of(const SlamResult& result, const std::string& kind) {
  std::vector<RunFinding> found;
  std::copy_if(result.findings.begin(), result.findings.end(), std::back_inserter(found),
               [&](const RunFinding& f) { return f.kind == kind; });
  return found;
}

SlamResult run(const testing::ToyLog& log, const SlamOptions& options = {}) {
  Slam slam(options);
  for (const RangeMeasurement& m : log.measurements) slam.add(m);
  return slam.finish();
}

TEST(Verdict, NothingOddIsGood) {
  const Judgement judged = judge_run(faultless(), false);
  EXPECT_EQ(judged.verdict.verdict, Verdict::kGood);
  EXPECT_GE(judged.verdict.probability, 0.97);
  EXPECT_LT(judged.verdict.probability, 1.0);
  EXPECT_EQ(judged.verdict.evidence.at("way_m"), 40.0);
}

TEST(Verdict, WhatSpeaksAgainstAMapNeverMakesItBetter) {
  const double best = judge_run(faultless(), false).verdict.probability;
  const auto worse = [&](auto&& change) {
    RunEvidence e = faultless();
    change(e);
    return judge_run(e, false).verdict.probability;
  };
  EXPECT_LT(worse([](RunEvidence& e) { e.map.far.tail.crossed = 0.8, e.map.far.tail.in_free = 0.8; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.excess.crossed = 0.3, e.excess.in_free = 0.3; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.lost_unaided = 0.4, e.unseen_ratio = 30.0; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.step_chi2_tail = 30.0, e.unseen_doubted = 10.0; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.expected_ratio = 10.0; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.off_map = 0.4, e.breaks = 4.0; }), 0.95);
  EXPECT_LT(worse([](RunEvidence& e) { e.off_map = 0.1, e.off_map_ratio = 1.0; }), 0.95);
  EXPECT_LE(worse([](RunEvidence& e) { e.wheels_slipped = 0.5; }), best);
}

TEST(Verdict, OneBadPlaceOfALongRunIsNoBadMap) {
  // What only an extreme over all keyframes shows is told, and not weighed.
  const double best = judge_run(faultless(), false).verdict.probability;
  RunEvidence e = faultless();
  e.map.far.worst = {0.5, 0.3, 0.2};
  e.step_bend_m = 0.3, e.jump = 8.0, e.longest_gap_m = 3.0;
  EXPECT_EQ(judge_run(e, false).verdict.probability, best);
}

TEST(Verdict, ARunOfWhichHalfIsOnNoMapHasFailed) {
  RunEvidence e = faultless();
  e.on_map = 0.49;
  EXPECT_EQ(judge_run(e, false).verdict.verdict, Verdict::kFailed);
  EXPECT_LE(judge_run(e, false).verdict.probability, 0.2);
}

TEST(Verdict, WheelsThatGoOnWhereTheScansStandLeaveARunDoubtful) {
  RunEvidence e = faultless();
  e.wheels_way_m = 9.8, e.wheels_seen_m = 1.6;
  const Judgement judged = judge_run(e, false);
  EXPECT_EQ(judged.verdict.verdict, Verdict::kDoubtful);
  EXPECT_EQ(judged.weights.front().kind, "wheels");
  e.wheels_seen_m = 6.0;
  EXPECT_EQ(judge_run(e, false).verdict.verdict, Verdict::kGood) << "they slip, as on any floor";
}

TEST(Verdict, ARunInPartsIsDoubtfulWhateverEachIsWorth) {
  RunEvidence e = faultless();
  EXPECT_EQ(judge_run(e, true).verdict.verdict, Verdict::kDoubtful);
  e.on_map = 0.3;
  EXPECT_EQ(judge_run(e, true).verdict.verdict, Verdict::kDoubtful);
}

TEST(Verdict, AWholeRunKnowsItsNumbers) {
  const testing::ToyLog log = testing::turning_lidar_log(150);
  const SlamResult result = run(log);
  EXPECT_EQ(result.verdict.verdict, Verdict::kGood) << result.verdict.probability;
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().kind;
  const auto& e = result.verdict.evidence;
  EXPECT_EQ(e.at("scans"), 150.0);
  EXPECT_EQ(e.at("on_map"), 1.0);
  EXPECT_EQ(e.at("lost"), 0.0);
  EXPECT_EQ(e.at("pieces"), 1.0);
  EXPECT_EQ(e.at("gaps"), 0.0);
  EXPECT_LT(e.at("jump_ratio"), 0.2);
  EXPECT_NEAR(e.at("duration_s"), 149 * 0.18, 1e-6);
  double way = 0.0;
  for (std::size_t i = 1; i < 150; ++i) way += translation_distance(log.truth[i - 1], log.truth[i]);
  EXPECT_NEAR(e.at("way_m"), way, 0.05 * way);
}

TEST(Verdict, ABoundedRunIsJudgedAsWell) {
  SlamOptions options;
  options.slam.bounded_memory = true;
  const SlamResult result = run(testing::turning_lidar_log(150), options);
  EXPECT_EQ(result.verdict.verdict, Verdict::kGood) << result.verdict.probability;
}

TEST(Verdict, ARunThatGoesOnFromAStateSaysTheSame) {
  const testing::ToyLog log = testing::turning_lidar_log(120);
  Slam first;
  for (std::size_t i = 0; i < 70; ++i) first.add(log.measurements[i]);
  Slam second(first.checkpoint(), SlamOptions{});
  for (std::size_t i = 70; i < 120; ++i) second.add(log.measurements[i]);
  const SlamResult whole = run(log), resumed = second.finish();
  EXPECT_EQ(whole.verdict.evidence, resumed.verdict.evidence);
  EXPECT_EQ(whole.verdict.probability, resumed.verdict.probability);
}

TEST(Verdict, AGapIsToldWithItsPlace) {
  testing::ToyLog log = testing::turning_lidar_log(150);
  const Stamp last = log.measurements[79].scan.stamp;
  log.measurements.erase(log.measurements.begin() + 80, log.measurements.begin() + 110);
  const SlamResult result = run(log);
  EXPECT_NEAR(result.verdict.evidence.at("longest_gap_s"), 31 * 0.18, 1e-6);
  EXPECT_GT(result.verdict.evidence.at("gaps"), 0.15);
  const auto gaps = findings_of(result, "gaps");
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0].first_stamp, last);
  EXPECT_EQ(gaps[0].scan, 79);
}

TEST(Verdict, AStepThatNoRobotMakesIsAJump) {
  testing::ToyLog log = testing::turning_lidar_log(150);
  // Twelve scans are gone and the clock does not show it: 0.9 m in one step of 0.18 s.
  log.measurements.erase(log.measurements.begin() + 60, log.measurements.begin() + 72);
  for (std::size_t i = 60; i < log.measurements.size(); ++i)
    log.measurements[i].scan.stamp -= stamp_from_seconds(12 * 0.18);
  const double far = translation_distance(log.truth[59], log.truth[72]);
  const auto e = run(log).verdict.evidence;
  EXPECT_LT(e.at("longest_gap_m"), 0.5) << "there is no gap in time";
  EXPECT_GT(e.at("jump_ratio"), 0.5 * far / 0.2);
  EXPECT_LT(e.at("jump_ratio"), far / 0.2);
}

TEST(Verdict, WheelsThatAgreeAnswerForScansThatWereLost) {
  testing::ToyLog without = testing::turning_lidar_log(150), with = without;
  for (std::size_t i = 0; i < with.measurements.size(); ++i) with.measurements[i].T_odom_base = with.truth[i];
  for (testing::ToyLog* log : {&without, &with})
    log->measurements.erase(log->measurements.begin() + 80, log->measurements.begin() + 110);
  const auto alone = run(without).verdict.evidence, aided = run(with).verdict.evidence;
  EXPECT_NEAR(alone.at("unseen_ratio"), alone.at("longest_gap_s") * alone.at("way_m") / alone.at("duration_s") / 0.2,
              1e-9);
  EXPECT_LT(aided.at("unseen_ratio"), 0.2 * alone.at("unseen_ratio"));
  // Wheels that jump elsewhere answer for no gap.
  with.measurements[20].T_odom_base = Pose2{50.0, 0.0, 0.0};
  const auto jumped = run(with).verdict.evidence;
  EXPECT_GT(jumped.at("wheels_agreed"), 0.9);
  EXPECT_GT(jumped.at("unseen_ratio"), 0.9 * alone.at("unseen_ratio"));
}

TEST(Verdict, WideSearchesThatSomethingConfirmsAreNoBadSign) {
  const double best = judge_run(faultless(), false).verdict.probability;
  const auto with = [](auto&& change) {
    RunEvidence e = faultless();
    e.degraded = 0.97;
    change(e);
    return judge_run(e, false).verdict.probability;
  };
  EXPECT_EQ(with([](RunEvidence&) {}), best) << "by itself it says how far the scans are apart";
  EXPECT_LT(with([](RunEvidence& e) { e.degraded_unconfirmed = 0.97; }), best);
  EXPECT_LT(with([](RunEvidence& e) { e.degraded_bent = 8.0; }), 0.95);
  EXPECT_LT(with([](RunEvidence& e) { e.open_doubted = 2.0; }), 0.95);
}

TEST(Verdict, WheelsAndLoopsConfirmTheStepsOfAThinnedLog) {
  testing::ToyLog without = testing::turning_lidar_log(400);
  std::vector<RangeMeasurement> kept;
  std::vector<Pose2> truth;
  for (std::size_t i = 0; i < without.measurements.size(); i += 6) {
    kept.push_back(without.measurements[i]);
    truth.push_back(without.truth[i]);
  }
  without.measurements = kept, without.truth = truth;
  testing::ToyLog with = without;
  for (std::size_t i = 0; i < with.measurements.size(); ++i) with.measurements[i].T_odom_base = with.truth[i];
  const SlamResult alone = run(without), aided = run(with);
  EXPECT_GT(alone.verdict.probability, 0.9);
  EXPECT_EQ(aided.verdict.verdict, Verdict::kGood) << aided.verdict.probability;
  const auto& a = alone.verdict.evidence;
  ASSERT_GT(a.at("degraded"), 0.5) << "nearly all need wide searches";
  ASSERT_GT(a.at("loops_per_keyframe"), 0.2);
  ASSERT_GT(a.at("step_chi2_tail"), 0.0);
  EXPECT_NEAR(a.at("degraded_unconfirmed"), a.at("degraded") / (1.0 + 2.0 * a.at("loops_per_keyframe")), 1e-9);
  EXPECT_NEAR(a.at("degraded_bent"), a.at("degraded") * a.at("step_chi2_tail"), 1e-9);
  EXPECT_NEAR(a.at("open_doubted"), a.at("expected_ratio") * a.at("doubted"), 1e-9);
  const auto& w = aided.verdict.evidence;
  ASSERT_GT(w.at("degraded"), 0.5);
  const double unaided = 1.0 - std::min(1.0, w.at("wheels")) * w.at("wheels_agreed");
  ASSERT_LT(unaided, 0.3) << "wheels agree";
  EXPECT_NEAR(w.at("degraded_bent"), unaided * w.at("degraded") * w.at("step_chi2_tail"), 1e-9);
  EXPECT_LE(w.at("degraded_unconfirmed"), unaided * w.at("degraded"));
}

TEST(Verdict, DrivesThatNothingTiesAreInPieces) {
  const testing::ToyLog one = testing::turning_lidar_log(60);
  Slam slam;
  for (const RangeMeasurement& m : one.measurements) slam.add(m);
  slam.begin_session();
  Random random(5);
  for (std::size_t i = 0; i < 60; ++i) {
    const Pose2 pose{4.0 + 0.04 * static_cast<double>(i), 0.0, 0.0};
    slam.add({testing::toy_scan(testing::corridor_with_niches(30.0, 0.7), pose, {}, random,
                                stamp_from_seconds(5000.0 + 0.18 * static_cast<double>(i)))});
  }
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.parts.size(), 2u);
  EXPECT_EQ(result.verdict.verdict, Verdict::kDoubtful);
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings.front().kind, "pieces");
  EXPECT_EQ(result.findings.front().count, 2u);
  for (const SlamResult& part : result.parts) {
    EXPECT_EQ(part.verdict.evidence.at("scans"), 60.0);
    EXPECT_GT(part.verdict.evidence.at("keyframes"), 2.0);
  }
}

TEST(Verdict, ScansOffTheMapAreWeighedByWhatARightMapMayBeOff) {
  testing::ToyLog log = testing::turning_lidar_log(60);
  Random random(5);
  const double begin = stamp_to_seconds(log.measurements.back().scan.stamp) + 100.0;
  for (std::size_t i = 0; i < 30; ++i) {
    const Pose2 pose{4.0 + 0.04 * static_cast<double>(i), 0.0, 0.0};
    log.measurements.push_back({testing::toy_scan(testing::corridor_with_niches(30.0, 0.7), pose, {}, random,
                                                  stamp_from_seconds(begin + 0.18 * static_cast<double>(i)))});
  }
  const SlamResult result = run(log);
  const auto& e = result.verdict.evidence;
  ASSERT_GT(e.at("off_map"), 0.2) << "carried elsewhere: nothing ties these scans to the map";
  ASSERT_LT(e.at("way_m"), 20.0);
  EXPECT_NEAR(e.at("off_map_ratio"), std::sqrt(e.at("off_map")) / 0.2, 1e-9);
  EXPECT_NE(result.verdict.verdict, Verdict::kGood);
}

TEST(Verdict, WheelsThatSlipAreAReason) {
  const SlamResult result = run(testing::wheels_log(150));
  const auto wheels = findings_of(result, "wheels");
  ASSERT_EQ(wheels.size(), 1u);
  EXPECT_EQ(wheels[0].count, result.wheels.slipped + result.wheels.reversed + result.wheels.jumped);
  // They count backwards from scan 31 on.
  EXPECT_GE(wheels[0].scan, 31);
  EXPECT_LE(wheels[0].scan, 33);
  EXPECT_EQ(wheels[0].first_stamp, result.scans[static_cast<std::size_t>(wheels[0].scan)].stamp);
}

TEST(Verdict, TheScanAtWhichWheelsSlippedFirstIsKeptInAState) {
  const testing::ToyLog log = testing::wheels_log(120);
  Slam first;
  for (std::size_t i = 0; i < 70; ++i) first.add(log.measurements[i]);
  Slam second(first.checkpoint(), SlamOptions{});
  for (std::size_t i = 70; i < 120; ++i) second.add(log.measurements[i]);
  const auto whole = findings_of(run(log), "wheels"), resumed = findings_of(second.finish(), "wheels");
  ASSERT_EQ(whole.size(), 1u);
  ASSERT_EQ(resumed.size(), 1u);
  EXPECT_GE(whole[0].scan, 31);
  EXPECT_EQ(whole[0].scan, resumed[0].scan);
}

}  // namespace
}  // namespace phasescan::verdict_test
