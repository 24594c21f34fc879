// What a run of days packs comes out as it went in.
#include "slam/packed_records.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/random.hpp"
#include "phasescan/slam/slam.hpp"
#include "phasescan/slam/state.hpp"
#include "support/toy_world.hpp"

namespace phasescan::packed_records_test {
namespace {

bool same(const ScanRecord& a, const ScanRecord& b) {
  return a.stamp == b.stamp && a.keyframe == b.keyframe && std::memcmp(&a.x, &b.x, sizeof a.x) == 0 &&
         std::memcmp(&a.y, &b.y, sizeof a.y) == 0 && std::memcmp(&a.theta, &b.theta, sizeof a.theta) == 0 &&
         a.status == b.status && a.repeated == b.repeated && a.left_out == b.left_out;
}

TEST(PackedRecords, ComeOutAsTheyWentIn) {
  Random random(3);
  std::vector<ScanRecord> all;
  Stamp stamp = 1'700'000'000'000'000'000;
  for (int i = 0; i < 1000; ++i) {
    ScanRecord record;
    record.stamp = stamp += 181'818'181 + static_cast<Stamp>(random.uniform(-1e6, 1e6));
    record.keyframe = i / 4 - 1;
    record.set({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-3, 3)});
    record.status = static_cast<TrackingStatus>(i % 5);
    record.repeated = i % 7 == 3;
    record.left_out = i % 11 == 5;
    all.push_back(record);
  }
  all[200].stamp = std::numeric_limits<Stamp>::min();
  all[201].stamp = std::numeric_limits<Stamp>::max();
  all[202].keyframe = std::numeric_limits<std::int32_t>::max();
  all[203].keyframe = -1;
  all[204].x = std::numeric_limits<float>::quiet_NaN();
  PackedRecords packed;
  packed.add(std::span(all).first(600));
  packed.add(std::span(all).subspan(600));
  ASSERT_EQ(packed.size(), all.size());
  const std::vector<ScanRecord> out = packed.records();
  ASSERT_EQ(out.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) ASSERT_TRUE(same(out[i], all[i])) << i;
  packed.clear();
  EXPECT_TRUE(packed.records().empty());
}

/// A robot that stands most of the time, for more scans than are held unpacked.
class LongRun : public ::testing::Test {
 protected:
  static constexpr int kEach = 1000, kPlaces = 12;
  LongRun() {
    options.slam.bounded_memory = true;
    const auto walls = testing::two_rooms();
    const auto tour = testing::toy_tour(0.5, 0.4, 0.05, 1);
    Random random(6);
    for (int place = 0; place < kPlaces; ++place)
      scans.push_back(testing::toy_scan(walls, tour[static_cast<std::size_t>(place)], {}, random, 0));
  }
  RangeMeasurement measurement(int i) const {
    RangeMeasurement out{scans[static_cast<std::size_t>(i / kEach)]};
    out.scan.stamp = stamp_from_seconds(1000.0 + 0.1 * i);
    return out;
  }
  SlamOptions options;
  std::vector<Scan> scans;
};

TEST_F(LongRun, KeepsThePoseOfEachScan) {
  Slam slam(options);
  std::vector<Pose2> odometry;
  for (int i = 0; i < kEach * kPlaces; ++i) odometry.push_back(slam.add(measurement(i)).T_odom_base);
  ASSERT_EQ(slam.scans(), odometry.size());
  const SlamState state = slam.checkpoint();
  EXPECT_EQ(state.scans(), odometry.size());
  EXPECT_EQ(summarize(state).first_stamp, stamp_from_seconds(1000.0));
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), odometry.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    ASSERT_EQ(result.scans[i].stamp, stamp_from_seconds(1000.0 + 0.1 * static_cast<double>(i)));
    // The first scans of a place may wait to be judged by the next: their poses were not known when they came.
    if (i % kEach < 3) continue;
    ASSERT_LT(translation_distance(result.scans[i].T_odom_base, odometry[i]), 0.02) << i;
  }
}

TEST_F(LongRun, GoesOnFromACheckpointWithTheSamePoses) {
  Slam whole(options), first(options);
  const int half = kEach * kPlaces * 3 / 4 + 17;
  for (int i = 0; i < kEach * kPlaces; ++i) whole.add(measurement(i));
  for (int i = 0; i < half; ++i) first.add(measurement(i));
  Slam second(first.checkpoint(), options);
  EXPECT_EQ(second.scans(), static_cast<std::size_t>(half));
  for (int i = half; i < kEach * kPlaces; ++i) second.add(measurement(i));
  const SlamResult a = whole.finish(), b = second.finish();
  ASSERT_EQ(a.scans.size(), b.scans.size());
  for (std::size_t i = 0; i < a.scans.size(); ++i) {
    ASSERT_EQ(a.scans[i].stamp, b.scans[i].stamp);
    ASSERT_EQ(a.scans[i].T_map_base, b.scans[i].T_map_base) << i;
  }
}

}  // namespace
}  // namespace phasescan::packed_records_test
