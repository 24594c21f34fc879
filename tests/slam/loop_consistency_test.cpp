// Which loops are accepted: small ones at once, the others when enough of them ask for the same correction.
#include "slam/loop_consistency.hpp"

#include <gtest/gtest.h>

namespace phasescan::loop_consistency_test {
namespace {

/// Nodes 0.25 m apart along the x axis, and loops between them that ask for a correction of the later end.
struct Way {
  std::vector<Pose2> poses;
  Way() {
    for (int k = 0; k < 200; ++k) poses.push_back({0.25 * k, 0.0, 0.0});
  }
  Pose2 at(int node) const { return poses[static_cast<std::size_t>(node)]; }
  Loop loop(int from, int to, const Pose2& correction) const {
    Loop loop;
    loop.from = from;
    loop.to = to;
    loop.T_from_to = at(from).inverse() * (correction * at(to));
    return loop;
  }
};

const Pose2 kSideways{0.0, 1.0, 0.0};

TEST(LoopConsistency, ALoopThatHardlyMovesTheMapIsAcceptedAtOnce) {
  const Way way;
  LoopConsistency consistency({});
  EXPECT_EQ(consistency.add(way.loop(10, 100, {0.1, 0.1, 0.0}), way.poses).size(), 1u);
  EXPECT_TRUE(consistency.add(way.loop(10, 101, {0.0, 0.4, 0.0}), way.poses).empty()) << "0.4 m is not small";
  // A turn about the later end itself: nothing but its heading is off.
  Loop turned = way.loop(10, 102, {});
  turned.T_from_to.theta = 0.1;
  EXPECT_TRUE(consistency.add(turned, way.poses).empty()) << "nor are 6 degrees";
}

TEST(LoopConsistency, BetweenPiecesASmallOneWaitsLikeAnyOther) {
  const Way way;
  LoopConsistency consistency({});
  EXPECT_TRUE(consistency.add(way.loop(10, 100, {}), way.poses, SmallLoops::kMustBeAgreedOn).empty());
  EXPECT_TRUE(consistency.add(way.loop(11, 101, {}), way.poses, SmallLoops::kMustBeAgreedOn).empty());
  EXPECT_EQ(consistency.add(way.loop(12, 102, {}), way.poses, SmallLoops::kMustBeAgreedOn).size(), 3u);
}

TEST(LoopConsistency, AsManyMustAgreeAsAreAskedFor) {
  const Way way;
  for (const int votes : {2, 3, 5}) {
    LoopOptions options;
    options.votes = votes;
    LoopConsistency consistency(options);
    for (int k = 1; k < votes; ++k)
      EXPECT_TRUE(consistency.add(way.loop(10 + k, 100 + k, kSideways), way.poses).empty()) << k << " of " << votes;
    EXPECT_EQ(consistency.add(way.loop(10, 100 + votes, kSideways), way.poses).size(), static_cast<std::size_t>(votes));
    EXPECT_TRUE(consistency.state().waiting.empty()) << "what was accepted waits no longer";
    EXPECT_TRUE(consistency.add(way.loop(10, 120, kSideways), way.poses).empty()) << "nor does it count again";
    EXPECT_EQ(consistency.rejected(), 0u);
  }
  EXPECT_EQ(LoopOptions{}.votes, 3) << "two may be wrong alike: both ends of a corridor look the same twice";
}

TEST(LoopConsistency, OthersThatAskForAnotherCorrectionDoNotCount) {
  const Way way;
  LoopConsistency consistency({});
  for (int k = 0; k < 10; ++k)
    EXPECT_TRUE(consistency.add(way.loop(10, 100 + k, {0.0, 1.0 + 0.5 * k, 0.0}), way.poses).empty()) << k;
  // The same place, another heading: 5 degrees apart.
  LoopConsistency headings({});
  for (int k = 0; k < 10; ++k) {
    Loop loop = way.loop(10, 100 + k, kSideways);
    loop.T_from_to.theta += 0.09 * k;
    EXPECT_TRUE(headings.add(loop, way.poses).empty()) << k;
  }
  EXPECT_EQ(headings.state().waiting.size(), 10u);
  headings.close();
  EXPECT_TRUE(headings.state().waiting.empty());
  EXPECT_EQ(headings.rejected(), 10u);
}

TEST(LoopConsistency, LoopsOfOneNodeAreOneVote) {
  const Way way;
  LoopConsistency consistency({});
  for (int k = 0; k < 6; ++k)
    EXPECT_TRUE(consistency.add(way.loop(10 + k, 100, kSideways), way.poses).empty()) << "one scan, seen six times";
}

TEST(LoopConsistency, WhatFoundNoOthersNearbyIsForgotten) {
  const Way way;
  LoopConsistency consistency({});
  EXPECT_TRUE(consistency.add(way.loop(10, 100, kSideways), way.poses).empty());
  EXPECT_TRUE(consistency.add(way.loop(11, 120, kSideways), way.poses).empty());
  EXPECT_TRUE(consistency.add(way.loop(12, 145, kSideways), way.poses).empty()) << "node 100 is too long ago";
  EXPECT_EQ(consistency.rejected(), 1u);
  EXPECT_EQ(consistency.add(way.loop(13, 147, kSideways), way.poses).size(), 3u);
}

TEST(LoopConsistency, NoMoreThan64Wait) {
  const Way way;
  LoopConsistency consistency({});
  for (int k = 0; k < 100; ++k)
    EXPECT_TRUE(consistency.add(way.loop(1 + k / 10, 150 + k / 10, {0.0, 1.0 + k, 0.0}), way.poses).empty());
  EXPECT_EQ(consistency.state().waiting.size(), 64u);
  EXPECT_EQ(consistency.rejected(), 36u);
}

}  // namespace
}  // namespace phasescan::loop_consistency_test
