// Poses that a robot may have: what is known of a lone one.
#include "localize/hypotheses.hpp"

#include <gtest/gtest.h>

#include "localize/likelihood.hpp"
#include "localize/map_grid.hpp"
#include "localize/past_views.hpp"
#include "localize/pose_confidence.hpp"
#include "support/toy_map.hpp"

namespace phasescan {
namespace {

FoundPose found_at(double x, double log_likelihood) {
  FoundPose pose;
  pose.T_grid_base = {x, 0.0, 0.0};
  pose.fit.log_likelihood = log_likelihood;
  return pose;
}

TEST(Hypotheses, OneThatIsLeftIsAsFarAheadAsTheOthersFellBehind) {
  HypothesisSet set;
  set.restart({found_at(0.0, -10.0)}, {}, 18.0, 12);
  EXPECT_EQ(set.margin(), kFoundFirst);
  set.merge({found_at(0.0, -10.0), found_at(5.0, -12.0)}, {}, 18.0, 12);
  ASSERT_EQ(set.all.size(), 2U);
  set.all[1].weight -= 15.0;  // views of the way speak against it
  set.prune(18.0, 12);
  ASSERT_EQ(set.all.size(), 1U);
  EXPECT_LT(set.margin(), 30.0);
  EXPECT_GT(set.margin(), 18.0);
}

TEST(Hypotheses, APlaceThatNothingLedToMustExplainMore) {
  HypothesisSet set;
  set.restart({found_at(0.0, -10.0)}, {}, 18.0, 12);
  set.merge({found_at(5.0, -9.0)}, {}, 18.0, 12);
  ASSERT_EQ(set.all.size(), 2U);
  EXPECT_EQ(set.all.front().at.T_grid_base.x, 0.0);
}

FoundPose explained_at(double x, double explained) {
  FoundPose pose = found_at(x, -10.0);
  pose.fit.explained = explained;
  return pose;
}

/// Shows the set a number of views that the map explains so far.
void see(HypothesisSet& set, double explained, int views) {
  for (Hypothesis& h : set.all) h.at.fit.explained = explained;
  for (int n = 0; n < views; ++n) set.see({}, 6.0);
}

TEST(Hypotheses, ViewsThatTheMapDoesNotExplainMakeAPoseLessSure) {
  HypothesisSet set;
  set.restart({explained_at(0.0, 0.9)}, {}, 18.0, 12);
  see(set, 0.9, 10);
  EXPECT_EQ(set.margin(), kMostMargin);
  see(set, 0.45, 4);
  EXPECT_LT(set.margin(), 42.0);
  see(set, 0.45, 20);
  EXPECT_EQ(set.margin(), 0.0);
  see(set, 0.9, 10);  // back where the map has walls
  EXPECT_GT(set.margin(), 40.0);
}

TEST(Hypotheses, WhatASearchFindsMustBeConfirmedByViews) {
  HypothesisSet set;
  for (const double x : {0.0, 10.0}) set.restart({explained_at(x, 0.9)}, {}, 18.0, 12);
  EXPECT_EQ(set.margin(), kFoundAgain);  // the second look
  see(set, 0.9, 3);
  EXPECT_GT(set.margin(), kFoundAgain + 17.0);
  set.restart({explained_at(10.1, 0.9)}, {}, 18.0, 12);  // where odometry led to as well
  EXPECT_GT(set.margin(), kFoundAgain + 17.0);
}

TEST(Hypotheses, WhatWasFollowedForLongAndIsFoundAgainIsSurer) {
  for (const int views : {kFollowedViews - 1, kFollowedViews}) {
    HypothesisSet set;
    set.restart({explained_at(0.0, 0.9)}, {}, 18.0, 12);
    see(set, 0.5, views);
    EXPECT_LT(set.margin(), 15.0);
    set.merge({explained_at(0.0, 0.7)}, {}, 18.0, 12);
    EXPECT_EQ(set.margin() >= kFoundWhereFollowed, views == kFollowedViews) << views;
  }
}

TEST(Hypotheses, WhatTheViewsBeforeSayCountsFromTheFirst) {
  for (const double of_past : {-30.0, 20.0}) {
    HypothesisSet set;
    FoundPose found = explained_at(5.0, 0.9);
    found.of_past = of_past;
    set.restart({found}, {}, 18.0, 12);
    EXPECT_EQ(set.margin(), kFoundFirst + of_past);
  }
}

TEST(Hypotheses, WhatLiesWhereTheMapKnowsNothingSaysNothingAboutWhereOdometryLeads) {
  MapFit fit;
  fit.explained = 0.4, fit.unmapped = 0.6, fit.unknown = 0.58, fit.hits = 100, fit.log_likelihood = -180.0;
  EXPECT_GT(explained_of_known(fit), 0.9);
  EXPECT_GT(log_likelihood_where_led(fit), -60.0);
  EXPECT_GT(evidence_of_view(fit, Led::kThere), 4.0);
  fit.unknown = 0.0;  // hits where the map is free: something is wrong
  EXPECT_LT(evidence_of_view(fit, Led::kThere), -1.0);
  fit.explained = 0.6;
  EXPECT_GT(evidence_of_view(fit, Led::kThere, 0.7), 3.0);
  fit.explained = 0.5;
  EXPECT_LT(evidence_of_view(fit, Led::kThere, 0.97), -2.0);  // where nearly all was explained until now
}

TEST(Hypotheses, WhereOdometryDidNotLeadAViewMustBeExplainedWell) {
  for (const double explained : {0.68, 0.95}) {
    HypothesisSet set;
    set.restart({explained_at(0.0, 0.9)}, {}, 18.0, 12);
    set.known = KnownPlace{{}, 1.0};
    set.restart({explained_at(5.0, explained)}, {}, 18.0, 12);
    see(set, explained, 4);
    EXPECT_EQ(set.margin() > kFoundElsewhere, explained > 0.9) << explained;
    set.known.reset();  // odometry broke: the robot may be anywhere
    see(set, explained, 8);
    EXPECT_GT(set.margin(), kFoundElsewhere) << explained;
  }
}

TEST(MapFit, ARayPastAnEdgeDoesNotContradictAndOneThroughAWallDoes) {
  // A wall along x = 3 from y = -2 on; it ends at y = 0.
  const std::vector<testing::Wall> walls = {
      {{-1, -2}, {6, -2}}, {{6, -2}, {6, 2}}, {{6, 2}, {-1, 2}}, {{-1, 2}, {-1, -2}}, {{3, -2}, {3, 0}}};
  const MapGrid grid = make_map_grid(testing::toy_map(walls, {0, 0}));
  const Pose2 T_grid = testing::toy_map(walls, {0, 0}).origin.inverse();
  const auto fit_of = [&](double y) {
    JudgedBeams beams;
    beams.x = {6.0F}, beams.y = {0.0F}, beams.dx = {1.0F}, beams.dy = {0.0F}, beams.range = {6.0F},
    beams.variance = {1e-4F};
    return fit_to_map(grid, beams, T_grid * Pose2{0.0, y, 0.0});
  };
  EXPECT_EQ(fit_of(-1.0).contradicting, 1.0);
  EXPECT_EQ(fit_of(0.02).contradicting, 0.0);
  EXPECT_EQ(fit_of(-0.03).contradicting, 0.0);
  EXPECT_EQ(fit_of(1.0).contradicting, 0.0);
}

TEST(MapFit, AHitFarFromAllThatIsMappedIsUnknown) {
  const std::vector<testing::Wall> walls = {{{0, 0}, {3, 0}}, {{3, 0}, {3, 3}}, {{3, 3}, {0, 3}}, {{0, 3}, {0, 0}}};
  TrinaryMap map = testing::toy_map(walls, {1, 1});
  const Pose2 T_grid = map.origin.inverse();
  for (int i = 0; i < map.width; ++i) {  // the right half was never seen
    for (int k = 0; k < map.height; ++k) {
      if ((map.origin * Eigen::Vector2d((i + 0.5) * map.resolution_m, 0.0)).x() > 1.5)
        map.cells[static_cast<std::size_t>(k * map.width + i)] = CellState::kUnknown;
    }
  }
  const MapGrid grid = make_map_grid(map);
  const auto fit_of = [&](float x) {
    JudgedBeams beams;
    beams.x = {x}, beams.y = {0.0F}, beams.dx = {1.0F}, beams.dy = {0.0F}, beams.range = {x}, beams.variance = {1e-4F};
    return fit_to_map(grid, beams, T_grid * Pose2{0.5, 1.5, 0.0});
  };
  EXPECT_EQ(fit_of(2.3F).unknown, 1.0);
  EXPECT_EQ(fit_of(0.7F).unknown, 0.0);  // someone who stands where the map is free
  EXPECT_EQ(fit_of(0.7F).unmapped, 1.0);
}

/// Two rooms that look alike but for their doors' ends: what was seen on the way to one speaks against the other.
TEST(PastViews, SpeakAgainstAPlaceThatTheyDoNotFit) {
  const std::vector<testing::Wall> walls = {{{0, 0}, {3, 0}}, {{3, 0}, {3, 3}}, {{3, 3}, {0, 3}}, {{0, 3}, {0, 0}}};
  const TrinaryMap map = testing::toy_map(walls, {1, 1});
  const MapGrid grid = make_map_grid(map);
  const Pose2 T_grid_odom = map.origin.inverse() * Pose2{1.5, 1.5, 0.0};
  const auto view = [](float range) {
    JudgedBeams beams;
    for (const auto& [dx, dy] : {std::pair{1.0F, 0.0F}, {0.0F, 1.0F}, {-1.0F, 0.0F}, {0.0F, -1.0F}}) {
      for (int n = 0; n < 2; ++n) {
        beams.x.push_back(range * dx), beams.y.push_back(range * dy), beams.dx.push_back(dx), beams.dy.push_back(dy);
        beams.range.push_back(range), beams.variance.push_back(1e-4F);
      }
    }
    return beams;
  };
  PastViews past;
  EXPECT_EQ(past.evidence(grid, T_grid_odom, Led::kUnknown), 0.0);
  past.add(view(2.5F), {}, 0.0);  // through all walls
  EXPECT_LT(past.evidence(grid, T_grid_odom, Led::kUnknown), -7.0);
  past.add(view(1.5F), {}, 0.25);
  past.add(view(1.5F), {}, 0.25);
  EXPECT_LT(past.evidence(grid, T_grid_odom, Led::kUnknown), 5.0);
  EXPECT_GT(past.evidence(grid, T_grid_odom, Led::kUnknown, 2), 7.0);
  past.clear();
  EXPECT_EQ(past.size(), 0U);
}

TEST(PoseConfidence, GrowsWithTheMarginToTheEndAndFallsWithWhatContradicts) {
  const PoseEvidence usual{30.0, 0.75, 0.02, 0.02};
  PoseEvidence ahead = usual, against = usual;
  ahead.margin = 60.0;
  against.contradicting = 0.3;
  EXPECT_GT(pose_confidence(ahead), 0.97);
  EXPECT_LT(pose_confidence(usual), 0.95);
  EXPECT_LT(pose_confidence(against), pose_confidence(usual) - 0.05);
}

TEST(DriveConfidence, FurnitureThatWasMovedTakesLittleFromWhatIsFollowed) {
  const double least = LocalizeOptions{}.min_confidence;
  EXPECT_GT(drive_confidence({50.0, 0.5, 0.02, 0.02}, true), least);
  EXPECT_LT(drive_confidence({50.0, 0.5, 0.4, 0.02}, true), least);
  EXPECT_LT(drive_confidence({10.0, 0.9, 0.0, 0.02}, true), least);
}

/// The first look at a place that explains four fifths of a scan may be one of a room alike.
TEST(DriveConfidence, WhatIsFoundNeedsAViewMore) {
  const double least = LocalizeOptions{}.min_confidence;
  const PoseEvidence first{kFoundFirst, 0.8, 0.0, 0.02}, next{kFoundFirst + 5.0, 0.8, 0.0, 0.02},
      whole{kFoundFirst, 0.97, 0.0, 0.02};
  EXPECT_LT(drive_confidence(first, false), least);
  EXPECT_GT(drive_confidence(next, false), least);
  EXPECT_GT(drive_confidence(whole, false), least);
}

}  // namespace
}  // namespace phasescan
