// Turns of which something is missing: what is left of them is of one turn of the head, or they are void.
#include "phasescan/live/turns.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan::live {
namespace {

constexpr int kBeams = 360;  // a turn
constexpr double kTurn_s = 0.18;

/// Beam number `k` of a head that turns evenly. @param marked  it says where a turn starts
Beam beam_at(int k, bool marked = true) {
  Beam beam;
  beam.sweep = kTwoPi * (k % kBeams) / kBeams;
  beam.angle = -beam.sweep;
  beam.range_m = 2.0F;
  beam.state = BeamState::kHit;
  beam.stamp = stamp_from_seconds(100.0 + kTurn_s * k / kBeams);
  if (marked && k % kBeams == 0) beam.mark = TurnMark::kStarts;
  return beam;
}

struct Turns {
  TurnAssembler assembler;
  std::vector<Scan> scans;
  void add(const Beam& beam) { assembler.add({&beam, 1}, 0.1, 12.0, scans); }
  void add(int from, int to, bool marked = true) {
    for (int k = from; k < to; ++k) add(beam_at(k, marked));
  }
};

/// Time from the first to the last beam of a scan.
double duration_s(const Scan& scan) {
  return scan.time_increment * static_cast<double>(scan.size() - 1);
}

class TornTurns : public ::testing::TestWithParam<bool> {};

/// The bytes stop in the middle of a turn and come again some turns later: no scan holds beams of both.
TEST_P(TornTurns, AScanHoldsBeamsOfOneTurn) {
  const bool marked = GetParam();
  for (const int away : {kBeams / 2 + 37, 4 * kBeams + 3, 9 * kBeams - 20, 12 * kBeams + 200}) {
    Turns turns;
    turns.add(0, 3 * kBeams + 150);
    const std::size_t before = turns.scans.size();
    const int back = 3 * kBeams + 150 + away;
    turns.add(back, back + 5 * kBeams, marked);
    EXPECT_EQ(before, 3U);
    for (const Scan& scan : turns.scans) EXPECT_LT(duration_s(scan), 1.1 * kTurn_s) << away;
    EXPECT_GE(turns.scans.size(), before + 4) << away;
    EXPECT_EQ(turns.assembler.counts().torn, away > kBeams ? 1U : 0U) << away;
  }
}
INSTANTIATE_TEST_SUITE_P(Marks, TornTurns, ::testing::Bool());

TEST(Turns, WhatIsLostWithinATurnDoesNotTearIt) {
  Turns turns;
  turns.add(0, 3 * kBeams + 50);
  turns.add(3 * kBeams + 200, 5 * kBeams + 1);
  ASSERT_EQ(turns.scans.size(), 5U);
  EXPECT_EQ(turns.assembler.counts().torn, 0U);
  EXPECT_EQ(turns.scans[3].size(), static_cast<std::size_t>(kBeams));
  EXPECT_EQ(turns.scans[3].hit_count(), static_cast<std::size_t>(kBeams - 150));
}

/// A packet whose check was right by chance and whose directions are not.
TEST(Turns, DirectionsThatAHeadCannotReachInTheTimeAreVoid) {
  Turns turns;
  turns.add(0, 2 * kBeams + 100);
  for (int k = 2 * kBeams + 100; k < 2 * kBeams + 120; ++k) {
    Beam beam = beam_at(k);
    beam.sweep = std::fmod(beam.sweep + kPi, kTwoPi);
    beam.angle = -beam.sweep;
    turns.add(beam);
  }
  turns.add(2 * kBeams + 120, 6 * kBeams + 1);
  EXPECT_GE(turns.assembler.counts().torn, 1U);
  EXPECT_GE(turns.scans.size(), 5U);
  for (const Scan& scan : turns.scans) {
    EXPECT_EQ(scan.size(), static_cast<std::size_t>(kBeams));
    EXPECT_EQ(scan.hit_count(), scan.size());
  }
}

TEST(Turns, AHeadThatChangesItsSpeedIsFollowed) {
  Turns turns;
  turns.add(0, 5 * kBeams);
  const Stamp from = beam_at(5 * kBeams).stamp;
  for (int k = 5 * kBeams; k < 25 * kBeams; ++k) {
    Beam beam = beam_at(k);
    beam.stamp = from + 3 * (beam.stamp - from);
    turns.add(beam);
  }
  EXPECT_GE(turns.scans.size(), 23U);
}

TEST(Turns, ABeamALittleBehindTheLastOneIsNoTurn) {
  Turns turns;
  turns.add(0, 2 * kBeams + 100);
  for (int k = 2 * kBeams + 100; k < 3 * kBeams; ++k) {
    Beam beam = beam_at(k);
    if (k % 20 == 0) beam.sweep -= 1.5 * kTwoPi / kBeams;
    turns.add(beam);
  }
  turns.add(3 * kBeams, 4 * kBeams + 1);
  ASSERT_EQ(turns.scans.size(), 4U);
  EXPECT_NEAR(static_cast<double>(turns.scans[2].size()), kBeams, 20.0) << "a step that looks long may look like a gap";
  EXPECT_EQ(turns.scans[2].hit_count(), static_cast<std::size_t>(kBeams));
  EXPECT_EQ(turns.assembler.counts().torn, 0U);
}

}  // namespace
}  // namespace phasescan::live
