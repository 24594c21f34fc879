// A run that goes on for days keeps the poses of some of its scans, and all else stays as it was.
#include <gtest/gtest.h>

#include <map>

#include "phasescan/core/time.hpp"
#include "phasescan/slam/slam.hpp"
#include "phasescan/slam/state.hpp"
#include "slam/old_path.hpp"
#include "slam/slam_state.hpp"
#include "support/toy_world.hpp"

namespace phasescan::path_thinning_test {
namespace {

using testing::toy_scan;
using testing::toy_tour;
using testing::two_rooms;

TEST(OldPath, HoldsAtMostSoManyScansEvenly) {
  OldPath old;
  ScanRecord record;
  const std::vector<ScanId> pinned{0, 333, 777};
  for (int i = 0; i < 40; ++i) {
    std::vector<ScanRecord> next;
    for (int k = 0; k < 50; ++k) {
      record.stamp = 50 * i + k;
      next.push_back(record);
    }
    old.add(next);
    old.thin(100, pinned);
    ASSERT_LE(old.scans().size(), 103U);
  }
  EXPECT_EQ(old.end(), 2000);
  ASSERT_GE(old.scans().size(), 50U);
  std::size_t uneven = 0;
  for (const OldScan& kept : old.scans()) {
    EXPECT_EQ(kept.scan, kept.record.stamp);
    uneven += kept.scan % 32 != 0;
  }
  EXPECT_EQ(uneven, 2U);
}

constexpr std::size_t kLimit = 200;

class PathThinning : public ::testing::Test {
 protected:
  PathThinning() { options.slam.bounded_memory = true; }

  /// Some laps: all is seen in the first.
  void drive(int laps) {
    const auto walls = two_rooms();
    Random random(6);
    for (const Pose2& pose : toy_tour(0.2, 0.4, 0.8, laps)) {
      RangeMeasurement next{toy_scan(walls, pose, {}, random, 0)};
      next.scan.stamp = stamp_from_seconds(1000.0 + 0.2 * static_cast<double>(measurements.size()));
      measurements.push_back(std::move(next));
    }
  }
  SlamOptions options;
  std::vector<RangeMeasurement> measurements;
};

struct Held {
  std::size_t scans = 0, keyframes = 0, nodes = 0, breaks = 0;
};

Held held_by(Slam& slam) {
  const SlamState state = slam.checkpoint();
  const SlamState::Data& data = state.data();
  return {data.ledger.records.size(), data.backend.session.submitted.size(), data.backend.session.keyframes.size(),
          data.ledger.breaks.size()};
}

std::map<Stamp, ScanResult> by_stamp(const SlamResult& result) {
  std::map<Stamp, ScanResult> scans;
  for (const ScanResult& scan : result.scans) scans[scan.stamp] = scan;
  return scans;
}

/// Those that were kept stand where they stand in a run that keeps all.
void expect_same_poses(const SlamResult& thinned, const SlamResult& whole) {
  const std::map<Stamp, ScanResult> all = by_stamp(whole);
  for (const ScanResult& scan : thinned.scans) {
    const auto same = all.find(scan.stamp);
    ASSERT_NE(same, all.end());
    // What the map corrected is spread from one keyframe that is kept to the next.
    ASSERT_LT(translation_distance(scan.T_map_base, same->second.T_map_base), 0.01);
    ASSERT_LT(translation_distance(scan.T_odom_base, same->second.T_odom_base), 0.01);
    ASSERT_EQ(scan.status, same->second.status);
    ASSERT_EQ(scan.on_map, same->second.on_map);
  }
}

TEST_F(PathThinning, NothingGrowsWithTime) {
  drive(12);
  ASSERT_GT(measurements.size(), 10 * kLimit);
  Slam slam(options), whole(options);
  slam.set_path_limit(kLimit);
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const ScanUpdate update = slam.add(measurements[i]), same = whole.add(measurements[i]);
    ASSERT_EQ(update.scan, static_cast<ScanId>(i));
    ASSERT_EQ(update.keyframe, same.keyframe);
    ASSERT_EQ(update.T_map_base(), same.T_map_base());
    if (i % 100 != 99) continue;
    const Held held = held_by(slam);
    // The path, what is not old yet, and the scans of the map.
    ASSERT_LE(held.scans, 3 * kLimit + held.nodes + 20) << i;
    ASSERT_LE(held.keyframes, held.scans + 20) << i;
  }
  EXPECT_EQ(slam.scans(), measurements.size());
  const SlamResult result = slam.finish(), all = whole.finish();
  EXPECT_LT(result.scans.size(), all.scans.size() / 3);
  EXPECT_GT(result.scans.size(), kLimit / 2);
  EXPECT_EQ(result.scans.front().stamp, all.scans.front().stamp);
  EXPECT_EQ(result.scans.back().stamp, all.scans.back().stamp);
  expect_same_poses(result, all);
  EXPECT_TRUE(result.map.cells == all.map.cells);
  ASSERT_EQ(result.keyframes.size(), all.keyframes.size());
  for (std::size_t k = 0; k < all.keyframes.size(); ++k) {
    EXPECT_EQ(result.keyframes[k].T_map_base, all.keyframes[k].T_map_base);
    EXPECT_EQ(result.scans[static_cast<std::size_t>(result.keyframes[k].scan)].stamp,
              all.scans[static_cast<std::size_t>(all.keyframes[k].scan)].stamp);
  }
}

TEST_F(PathThinning, WhatIsSavedIsARunLikeAnyOther) {
  drive(6);
  const std::size_t half = measurements.size() / 2;
  Slam slam(options), whole(options);
  slam.set_path_limit(kLimit);
  for (const RangeMeasurement& m : measurements) whole.add(m);
  for (std::size_t i = 0; i < half; ++i) slam.add(measurements[i]);
  // Reading checks that all numbers fit together.
  const SavedRun saved = decode_state(encode_state({slam.checkpoint(), options}));
  EXPECT_LT(saved.state.scans(), half);
  EXPECT_EQ(summarize(saved.state).last_stamp, measurements[half - 1].scan.stamp);
  Slam second(saved.state, saved.options);
  second.set_path_limit(kLimit);
  for (std::size_t i = half; i < measurements.size(); ++i) second.add(measurements[i]);
  const Held held = held_by(second);
  EXPECT_LE(held.scans, 3 * kLimit + 2 * held.nodes + 20);
  expect_same_poses(second.finish(), whole.finish());
}

TEST_F(PathThinning, DrivesStayApartAndTheirBeginningsAreKept) {
  drive(6);
  const std::size_t third = measurements.size() / 3;
  Slam slam(options), whole(options);
  slam.set_path_limit(kLimit);
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    if (i == third || i == 2 * third) {
      slam.begin_session();
      whole.begin_session();
    }
    slam.add(measurements[i]);
    whole.add(measurements[i]);
  }
  const SavedRun saved = decode_state(encode_state({slam.checkpoint(), options}));
  EXPECT_EQ(summarize(saved.state).drives, 3);
  const SlamResult result = slam.finish(), all = whole.finish();
  ASSERT_EQ(result.sessions.size(), 3U);
  for (const std::size_t drive : {1U, 2U})
    EXPECT_EQ(result.scans[static_cast<std::size_t>(result.sessions[drive].first_scan)].stamp,
              measurements[drive * third].scan.stamp);
  expect_same_poses(result, all);
  ASSERT_EQ(result.parts.size(), all.parts.size());
}

/// A robot that stands makes no keyframes, and one whose laser is covered no poses.
TEST_F(PathThinning, AStandingAndACoveredRobotKeepNoMore) {
  drive(1);
  for (const bool covered : {false, true}) {
    Slam slam(options);
    slam.set_path_limit(kLimit);
    for (std::size_t i = 0; i < 20; ++i) slam.add(measurements[i]);
    const RangeMeasurement& standing = measurements[20];
    std::vector<float> ranges = standing.scan.ranges;
    if (covered) std::fill(ranges.begin(), ranges.end(), 0.0F);
    Stamp last = standing.scan.stamp;
    // The first 3000 scans are held until it is known whether the robot is in the laser's view.
    for (std::size_t i = 0; i < 3000 + 8 * kLimit; ++i) {
      ranges[0] = 9.0F + 0.001F * static_cast<float>(i);  // no message comes twice
      RangeMeasurement next{make_scan(ranges, standing.scan.geometry)};
      next.scan.stamp = last += stamp_from_seconds(0.2);
      slam.add(next);
    }
    const Held held = held_by(slam);
    EXPECT_LE(held.scans, 3 * kLimit + held.nodes + 40) << covered;
    const SavedRun saved = decode_state(encode_state({slam.checkpoint(), options}));
    EXPECT_EQ(summarize(saved.state).last_stamp, last);
  }
}

}  // namespace
}  // namespace phasescan::path_thinning_test
