// Poses of scans from those of keyframes.
#include "slam/scan_ledger.hpp"

#include <gtest/gtest.h>

namespace phasescan::scan_ledger_test {
namespace {

/// Four scans to each of two keyframes, 0.25 m apart.
ScanLedger straight_on() {
  ScanLedger ledger;
  for (int i = 0; i < 8; ++i) {
    ScanRecord record;
    record.keyframe = i / 4;
    record.set({0.25 * (i % 4), 0.0, 0.0});
    ledger.records.push_back(record);
  }
  ledger.keyframes = 2;
  return ledger;
}

const std::vector<Pose2> kOdometry = {{0, 0, 0}, {1, 0, 0}};
const std::vector<Pose2> kOnMap = {{0, 0, 0}, {1, 0.2, 0}};

TEST(ScanLedger, WhatTheMapCorrectsIsSpreadEvenlyOverTheWayBetweenKeyframes) {
  const std::vector<Pose2> poses = poses_of_scans(straight_on(), kOnMap, kOdometry);
  ASSERT_EQ(poses.size(), 8U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].x, 0.25 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(poses[i].y, i < 4 ? 0.05 * static_cast<double>(i) : 0.2, 1e-9);
  }
}

TEST(ScanLedger, ABreakOfTrackingBendsNothingBeforeIt) {
  ScanLedger ledger = straight_on();
  ledger.breaks = {1};
  const std::vector<Pose2> poses = poses_of_scans(ledger, kOnMap, kOdometry);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(poses[i], (Pose2{0.25 * static_cast<double>(i), 0.0, 0.0}));
}

}  // namespace
}  // namespace phasescan::scan_ledger_test
