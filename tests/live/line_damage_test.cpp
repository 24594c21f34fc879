// Where most beams are lost no pose is called ok, and it is said once.
#include "live/line_damage.hpp"

#include <gtest/gtest.h>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan::live {
namespace {

LiveUpdate judged(LineDamage& damage, double lost, TrackingStatus status = TrackingStatus::kOk) {
  LiveUpdate update;
  update.update.status = status;
  update.confidence = 0.9;
  damage.add(lost);
  damage.judge(update);
  return update;
}

TEST(LineDamage, NoPoseIsOkWhereMostIsLost) {
  LineDamage damage;
  std::size_t told = 0;
  for (int i = 0; i < 20; ++i) {
    const LiveUpdate update = judged(damage, 0.8);
    told += update.warnings.size();
    if (i < 5) continue;
    EXPECT_EQ(update.update.status, TrackingStatus::kDegraded);
    EXPECT_LE(update.confidence, 0.5);
  }
  EXPECT_EQ(told, 1U);
  EXPECT_EQ(judged(damage, 0.8, TrackingStatus::kLost).update.status, TrackingStatus::kLost);
  for (int i = 0; i < 20; ++i) told += judged(damage, 0.1).warnings.size();
  EXPECT_EQ(told, 2U) << "that it is better, too";
  EXPECT_EQ(judged(damage, 0.1).update.status, TrackingStatus::kOk);
  EXPECT_EQ(judged(damage, 0.1).confidence, 0.9);
}

TEST(LineDamage, OneBadTurnIsNoDamagedLine) {
  LineDamage damage;
  for (int i = 0; i < 20; ++i) judged(damage, 0.05);
  EXPECT_EQ(judged(damage, 0.9).update.status, TrackingStatus::kOk);
  EXPECT_EQ(judged(damage, 0.05).update.status, TrackingStatus::kOk);
}

TEST(LineDamage, BeamsAndTurnsThatAreMissingAreLost) {
  Scan scan = make_scan(std::vector<float>(100, 1.0F), {0.0, kTwoPi / 100.0, 0.0, 0.0});
  scan.time_increment = 0.001;
  scan.stamp = stamp_from_seconds(50.0);
  EXPECT_EQ(lost_share(scan, std::nullopt), 0.0);
  for (std::size_t i = 0; i < 20; ++i) scan.states[i] = BeamState::kInvalid;
  EXPECT_NEAR(lost_share(scan, std::nullopt), 0.2, 1e-9);
  EXPECT_NEAR(lost_share(scan, scan.stamp - stamp_from_seconds(0.1)), 0.2, 1e-9);
  EXPECT_NEAR(lost_share(scan, scan.stamp - stamp_from_seconds(1.0)), 1.0 - 0.8 / 10.0, 1e-9);
}

TEST(LineDamage, OnAKnownMapToo) {
  LineDamage damage;
  for (int i = 0; i < 20; ++i) damage.add(0.8);
  LiveUpdate update;
  update.update.status = TrackingStatus::kOk;
  update.located.emplace().status = TrackingStatus::kOk;
  damage.judge(update);
  EXPECT_EQ(update.located->status, TrackingStatus::kDegraded);
}

}  // namespace
}  // namespace phasescan::live
