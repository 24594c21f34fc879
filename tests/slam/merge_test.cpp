// Saved runs become one map where they show the same places, and stay apart where they do not.
#include <gtest/gtest.h>

#include "phasescan/slam/state.hpp"
#include "slam/slam_state.hpp"
#include "slam/state_types.hpp"
#include "support/state_bytes.hpp"
#include "support/toy_world.hpp"

namespace phasescan::merge_test {
namespace {

using testing::to_bytes;

struct Drive {
  std::vector<RangeMeasurement> measurements;
  std::vector<Pose2> truth;
};

/// A part of the tour through a world, from a pose of its own on.
Drive drive_through(const std::vector<testing::Wall>& walls, std::size_t from, std::size_t scans, double start_s) {
  const auto tour = testing::toy_tour(0.18, 0.5, 1.5, 2);
  Random random(from + 1);
  Drive drive;
  for (std::size_t i = from; i < from + scans && i < tour.size(); ++i) {
    const Stamp stamp = stamp_from_seconds(start_s + 0.18 * static_cast<double>(i - from));
    drive.measurements.push_back({testing::toy_scan(walls, tour[i], {}, random, stamp)});
    drive.truth.push_back(tour[i]);
  }
  return drive;
}

/// Two rooms that look like no place in the other world.
std::vector<testing::Wall> other_rooms() {
  std::vector<testing::Wall> walls;
  testing::add_box(walls, -4, -3.2, 10, 4.4);
  testing::add_box(walls, -3.1, 1.2, -0.4, 3.9);
  testing::add_box(walls, 1.2, -2.9, 2.6, -1.1);
  testing::add_box(walls, 7.9, -2.6, 9.3, -1.7);
  walls.push_back({{3.0, 4.4}, {5.5, 1.6}});
  return walls;
}

SlamState run_of(const Drive& drive, const SlamOptions& options = {}) {
  Slam slam(options);
  for (const RangeMeasurement& m : drive.measurements) slam.add(m);
  return slam.checkpoint();
}

SlamResult finished(const SlamState& state, const SlamOptions& options = {}) {
  Slam slam(state, options);
  return slam.finish();
}

/// How far poses are off at most, with those of `T_world_map` taken for the truth's frame.
double worst_error_m(const SlamResult& result, std::size_t first, const Drive& drive, const Pose2& T_world_map) {
  double worst = 0.0;
  for (std::size_t i = 0; i < drive.truth.size(); ++i)
    worst = std::max(worst, translation_distance(T_world_map * result.scans[first + i].T_map_base, drive.truth[i]));
  return worst;
}

class Merge : public ::testing::TestWithParam<bool> {
 protected:
  SlamOptions options() const {
    SlamOptions options;
    options.slam.bounded_memory = GetParam();
    return options;
  }
};

TEST_P(Merge, DrivesThroughOnePlaceBecomeOneMap) {
  const Drive a = drive_through(testing::two_rooms(), 0, 170, 100.0),
              b = drive_through(testing::two_rooms(), 120, 170, 5000.0),
              c = drive_through(testing::two_rooms(), 60, 90, 9000.0);
  const MergedStates merged =
      merge_states({run_of(a, options()), run_of(b, options()), run_of(c, options())}, options());
  EXPECT_EQ(merged.order, (std::vector<std::size_t>{0, 1, 2}));
  const SlamResult result = finished(merged.state, options());
  EXPECT_EQ(result.pieces, 1);
  EXPECT_TRUE(result.parts.empty());
  ASSERT_EQ(result.scans.size(), 430u);
  ASSERT_EQ(result.sessions.size(), 3u);
  EXPECT_EQ(result.sessions[2].first_scan, 340);
  const Pose2 T_world_map = a.truth.front();
  EXPECT_LT(worst_error_m(result, 0, a, T_world_map), 0.05);
  EXPECT_LT(worst_error_m(result, 170, b, T_world_map), 0.05);
  EXPECT_LT(worst_error_m(result, 340, c, T_world_map), 0.05);
}

TEST_P(Merge, TheOrderGivenSaysTheFrameAlone) {
  const Drive a = drive_through(testing::two_rooms(), 0, 150, 100.0),
              b = drive_through(testing::two_rooms(), 100, 150, 5000.0);
  const SlamState first = run_of(a, options()), second = run_of(b, options());
  const MergedStates one = merge_states({first, second}, options()), other = merge_states({second, first}, options());
  EXPECT_EQ(other.order, (std::vector<std::size_t>{1, 0}));
  const SlamResult in_a = finished(one.state, options()), in_b = finished(other.state, options());
  ASSERT_EQ(in_a.scans.size(), in_b.scans.size());
  EXPECT_EQ(in_a.pieces, 1);
  EXPECT_EQ(in_b.pieces, 1);
  EXPECT_LT(worst_error_m(in_b, 150, b, b.truth.front()), 0.05);
  const Pose2 T_b_a = in_b.scans[0].T_map_base * in_a.scans[0].T_map_base.inverse();
  for (std::size_t i = 0; i < in_a.scans.size(); ++i) {
    EXPECT_EQ(in_a.scans[i].stamp, in_b.scans[i].stamp);
    EXPECT_LT(translation_distance(T_b_a * in_a.scans[i].T_map_base, in_b.scans[i].T_map_base), 0.02) << i;
  }
  // Nothing else: in one frame they are one state.
  EXPECT_EQ(one.state.data().backend.session.graph.edges().size(),
            other.state.data().backend.session.graph.edges().size());
  EXPECT_EQ(to_bytes(one.state.data().store), to_bytes(other.state.data().store));
}

TEST_P(Merge, WhatNothingTiesIsAResultByItselfLargestFirst) {
  const Drive a = drive_through(testing::two_rooms(), 0, 90, 100.0), b = drive_through(other_rooms(), 40, 170, 5000.0),
              c = drive_through(testing::two_rooms(), 30, 120, 9000.0);
  const SlamState run_a = run_of(a, options()), run_b = run_of(b, options()), run_c = run_of(c, options());
  for (const bool b_first : {false, true}) {
    const std::vector<SlamState> runs =
        b_first ? std::vector<SlamState>{run_b, run_c, run_a} : std::vector<SlamState>{run_a, run_b, run_c};
    const SlamResult result = finished(merge_states(runs, options()).state, options());
    ASSERT_EQ(result.parts.size(), 2u);
    EXPECT_GE(result.parts[0].keyframes.size(), result.parts[1].keyframes.size());
    const std::int32_t of_b = result.sessions[1].part;
    EXPECT_EQ(result.sessions[0].part, result.sessions[2].part);
    EXPECT_NE(result.sessions[0].part, of_b);
    const SlamResult &rooms = result.parts[static_cast<std::size_t>(1 - of_b)],
                     &elsewhere = result.parts[static_cast<std::size_t>(of_b)];
    ASSERT_EQ(elsewhere.scans.size(), b.truth.size());
    EXPECT_LT(worst_error_m(elsewhere, 0, b, b.truth.front()), 0.05);
    EXPECT_LT(worst_error_m(rooms, 0, a, a.truth.front()), 0.05);
    EXPECT_LT(worst_error_m(rooms, a.truth.size(), c, a.truth.front()), 0.05);
    // The first one given has the frame of the whole.
    const std::size_t begin = b_first ? a.truth.size() : 0;
    EXPECT_LT(worst_error_m(result, begin, b_first ? b : a, (b_first ? b : a).truth.front()), 0.05);
  }
}

TEST_P(Merge, ADriveOfWhichNoKeyframeIsOnItsMapYetIsAPieceToo) {
  const Drive a = drive_through(testing::two_rooms(), 0, 60, 100.0), b = drive_through(other_rooms(), 0, 12, 5000.0);
  const SlamState run_b = run_of(b, options());
  EXPECT_TRUE(run_b.data().backend.session.keyframes.empty());
  const SlamResult result = finished(merge_states({run_of(a, options()), run_b}, options()).state, options());
  EXPECT_EQ(result.pieces, 2);
  EXPECT_EQ(result.parts.size(), 2u);
}

TEST_P(Merge, GoesOnWithTheLastRun) {
  const Drive a = drive_through(testing::two_rooms(), 0, 150, 100.0),
              b = drive_through(testing::two_rooms(), 100, 200, 5000.0);
  Drive begun = b;
  begun.measurements.resize(120);
  const MergedStates merged = merge_states({run_of(a, options()), run_of(begun, options())}, options());
  Slam slam(merged.state, options());
  for (std::size_t i = 120; i < b.measurements.size(); ++i) {
    const ScanUpdate update = slam.add(b.measurements[i]);
    EXPECT_EQ(update.scan, static_cast<ScanId>(150 + i));
    EXPECT_LT(translation_distance(update.T_map_base(), a.truth.front().inverse() * b.truth[i]), 0.15) << i;
  }
  const SlamResult result = slam.finish();
  EXPECT_EQ(result.pieces, 1);
  EXPECT_EQ(result.sessions.size(), 2u);
  EXPECT_LT(worst_error_m(result, 150, b, a.truth.front()), 0.05);
}

TEST_P(Merge, ASavedMergedRunEndsWithTheSameBytes) {
  const Drive a = drive_through(testing::two_rooms(), 0, 100, 100.0),
              b = drive_through(testing::two_rooms(), 60, 100, 5000.0), c = drive_through(other_rooms(), 0, 60, 9000.0);
  const MergedStates merged =
      merge_states({run_of(b, options()), run_of(c, options()), run_of(a, options())}, options());
  const SavedRun loaded = decode_state(encode_state({merged.state, options()}));
  EXPECT_EQ(to_bytes(loaded.state.data()), to_bytes(merged.state.data()));
  const SlamResult now = finished(merged.state, options()), then = finished(loaded.state, options());
  StateWriter one, other;
  for (const ScanResult& s : now.scans) one.write(s.T_map_base);
  for (const ScanResult& s : then.scans) other.write(s.T_map_base);
  EXPECT_EQ(one.bytes, other.bytes);
  EXPECT_EQ(then.parts.size(), 2u);
  // And is merged again as any other.
  const Drive d = drive_through(testing::two_rooms(), 150, 100, 20000.0);
  const SlamResult again = finished(merge_states({loaded.state, run_of(d, options())}, options()).state, options());
  ASSERT_EQ(again.parts.size(), 2u);
  EXPECT_EQ(again.sessions[3].part, again.sessions[0].part);
}

INSTANTIATE_TEST_SUITE_P(Bounded, Merge, ::testing::Bool());

/// Cells of a box's sides that are occupied, and how many there are.
std::pair<int, int> occupied_of_box(const SlamResult& result, const Pose2& T_map_world, double x1, double y1, double x2,
                                    double y2) {
  std::pair<int, int> count{0, 0};
  std::vector<testing::Wall> sides;
  testing::add_box(sides, x1, y1, x2, y2);
  for (const testing::Wall& side : sides) {
    for (double t = 0.0; t < 1.0; t += 0.1) {
      const Eigen::Vector2d at = T_map_world * Eigen::Vector2d(side.a + t * (side.b - side.a));
      bool occupied = false;
      for (const double dx : {-0.05, 0.0, 0.05}) {
        for (const double dy : {-0.05, 0.0, 0.05}) {
          const int i = static_cast<int>((at.x() + dx - result.map.origin.x) / result.map.resolution_m),
                    k = static_cast<int>((at.y() + dy - result.map.origin.y) / result.map.resolution_m);
          occupied = occupied || result.map.at(i, k) == CellState::kOccupied;
        }
      }
      count.first += occupied;
      ++count.second;
    }
  }
  return count;
}

TEST(MergeStates, WithUpdateTheMapShowsWhatStandsThereNow) {
  auto then = testing::two_rooms(), now = testing::two_rooms();
  testing::add_box(then, -1.0, 0.8, -0.2, 1.6);  // a box that is moved across the room
  testing::add_box(now, 0.9, -2.2, 1.7, -1.4);
  const Drive a = drive_through(then, 0, 190, 100.0), b = drive_through(now, 150, 60, 5000.0);
  const SlamState run_a = run_of(a), run_b = run_of(b);
  const auto occupied = [&](const std::vector<SlamState>& runs, bool update, double x1, double y1, double x2,
                            double y2) {
    SlamOptions options;
    options.map.miss_log_odds = -0.1;  // one drive past what is gone does not outweigh that it was there
    options.map.update = update;
    const SlamResult result = finished(merge_states(runs, options).state, options);
    EXPECT_EQ(result.pieces, 1);
    return occupied_of_box(result, a.truth.front().inverse(), x1, y1, x2, y2);
  };
  const auto before = occupied({run_a}, true, -1.0, 0.8, -0.2, 1.6),
             kept = occupied({run_a, run_b}, false, -1.0, 0.8, -0.2, 1.6),
             gone = occupied({run_a, run_b}, true, -1.0, 0.8, -0.2, 1.6),
             fresh = occupied({run_a, run_b}, true, 0.9, -2.2, 1.7, -1.4);
  EXPECT_GT(before.first, before.second / 4);  // the sides that it showed
  EXPECT_GT(kept.first, before.first / 2);
  EXPECT_LT(gone.first, kept.first / 3);
  EXPECT_GT(fresh.first, fresh.second / 4);
}

TEST(MergeStates, RefusesWhatCannotBeMerged) {
  const Drive a = drive_through(testing::two_rooms(), 0, 30, 100.0);
  SlamOptions bounded;
  bounded.slam.bounded_memory = true;
  EXPECT_THROW(merge_states({}, {}), std::invalid_argument);
  EXPECT_THROW(merge_states({run_of(a), Slam().checkpoint()}, {}), std::invalid_argument);
  EXPECT_THROW(merge_states({run_of(a), run_of(a, bounded)}, {}), std::invalid_argument);
}

TEST(MergeStates, OneRunAloneIsWhatItWas) {
  const Drive a = drive_through(testing::two_rooms(), 0, 120, 100.0);
  const SlamResult alone = finished(run_of(a)), merged = finished(merge_states({run_of(a)}, {}).state);
  ASSERT_EQ(alone.scans.size(), merged.scans.size());
  for (std::size_t i = 0; i < alone.scans.size(); ++i)
    EXPECT_LT(translation_distance(alone.scans[i].T_map_base, merged.scans[i].T_map_base), 1e-3) << i;
}

}  // namespace
}  // namespace phasescan::merge_test
