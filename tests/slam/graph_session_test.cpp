// What the graph does with loops: small errors, large ones, and loops that the steps of tracking contradict.
#include "slam/graph_session.hpp"

#include <gtest/gtest.h>

namespace phasescan::graph_session_test {
namespace {

/// Keyframes 0.25 m apart, as tracking sees them; `turn` of each step [rad].
GraphSession driven(int nodes, double turn = 0.0, double sigma_m = 0.01, double sigma_rad = 0.004) {
  GraphSession session((LoopOptions()));
  Pose2 T_odom_base;
  for (int k = 0; k < nodes; ++k) {
    Keyframe keyframe;
    keyframe.T_odom_base = T_odom_base;
    keyframe.information =
        Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m), 1.0 / (sigma_rad * sigma_rad))
            .asDiagonal();
    session.insert_node(std::move(keyframe));
    T_odom_base = T_odom_base * Pose2{0.25, 0.0, turn};
  }
  return session;
}

/// Of a match that is sure to 2 cm and a degree.
Loop loop(int from, int to, const Pose2& T_from_to) {
  Loop loop;
  loop.from = from;
  loop.to = to;
  loop.T_from_to = T_from_to;
  loop.information = Eigen::Vector3d(2500.0, 2500.0, 3300.0).asDiagonal();
  return loop;
}

std::size_t loops_in(const GraphSession& session) {
  std::size_t count = 0;
  for (const PoseEdge& edge : session.graph().edges()) count += edge.robust && edge.enabled;
  return count;
}

Pose2 end_of(const GraphSession& session) {
  return session.poses().back();
}

TEST(GraphSession, LoopsThatWaitForOthersDoNotMoveTheMapAlone) {
  GraphSession session = driven(50);
  session.add_loop(loop(0, 49, {12.25, 0.1, 0.0}));
  EXPECT_FALSE(session.optimize_if_due()) << "0.1 m can wait";
  EXPECT_DOUBLE_EQ(end_of(session).y, 0.0);
  session.add_loop(loop(0, 49, {12.25, 0.5, 0.0}));
  EXPECT_TRUE(session.optimize_if_due()) << "half a metre cannot";
  EXPECT_GT(end_of(session).y, 0.05);
  GraphSession longer = driven(60);
  longer.add_loop(loop(0, 59, {14.75, 0.1, 0.0}));
  EXPECT_TRUE(longer.optimize_if_due()) << "with so many new nodes it is due";
}

TEST(GraphSession, ALargeCorrectionThatTheStepsAllowIsMade) {
  // Each step turned by 0.004 rad too much: 3 m and 0.8 rad off after 50 m. Past the reach of the robust kernel.
  GraphSession session = driven(200, 0.004);
  for (const int k : {0, 4, 8}) session.add_loop(loop(k, 199 - k, {0.25 * (199 - 2 * k), 0.0, 0.0}));
  ASSERT_GT(translation_distance(end_of(session), session.poses()[0] * Pose2{49.75, 0.0, 0.0}), 3.0);
  EXPECT_TRUE(session.optimize_if_due());
  EXPECT_LT(translation_distance(end_of(session), Pose2{49.75, 0.0, 0.0}), 0.1);
  EXPECT_EQ(loops_in(session), 3u);
}

/// Loops between the eight first and the four last nodes that put the end `aside` [m].
void add_many_loops(GraphSession& session, double aside) {
  for (int k = 0; k < 30; ++k) {
    const int from = k % 8, to = session.last_node() - k / 8;
    session.add_loop(loop(from, to, {0.25 * (to - from), aside, 0.0}));
  }
}

TEST(GraphSession, LargeLoopsThatTheStepsContradictAreTakenOut) {
  // Steps known to a centimetre and a quarter of a degree, and loops that put the end of 10 m of them 3 m aside: they
  // agree with each other, and are of two places that look alike. There are enough of them to hold the graph bent.
  GraphSession session = driven(41);
  const std::vector<Pose2> before = session.poses();
  add_many_loops(session, 3.0);
  EXPECT_TRUE(session.optimize_if_due());
  EXPECT_EQ(loops_in(session), 0u);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LT(translation_distance(session.poses()[k], before[k]), 1e-6);
}

TEST(GraphSession, AnUndoneLoopThatFitsAgainIsTakenBack) {
  GraphSession session = driven(41);
  session.add_loop(loop(0, 40, {10.0, 0.9, 0.0}));
  EXPECT_TRUE(session.optimize_if_due());
  ASSERT_EQ(loops_in(session), 0u) << "one against forty steps";
  add_many_loops(session, 0.9);
  EXPECT_TRUE(session.optimize_if_due());
  EXPECT_NEAR(end_of(session).y, 0.9, 0.05);
  EXPECT_EQ(loops_in(session), 31u);
}

TEST(GraphSession, ASmallerLoopThatTheRestContradictsIsUndone) {
  GraphSession session = driven(41);
  for (const int k : {0, 1, 2}) session.add_loop(loop(k, 40 - k, {0.25 * (40 - 2 * k), 0.0, 0.0}));
  session.add_loop(loop(3, 37, {8.5, 0.9, 0.0}));
  EXPECT_TRUE(session.optimize_if_due());
  EXPECT_EQ(loops_in(session), 3u);
  EXPECT_FALSE(session.graph().edges().back().enabled);
  EXPECT_LT(std::abs(end_of(session).y), 0.05);
}

TEST(GraphSession, OfALastPassOldLoopsStayOnlyWhereNoNewOneReaches) {
  GraphSession session = driven(41);
  session.add_loop(loop(0, 30, {7.5, 0.0, 0.0}));
  session.add_loop(loop(0, 40, {10.0, 0.02, 0.0}));
  const std::vector<Loop> again = {loop(1, 40, {9.75, 0.0, 0.0}), loop(2, 40, {9.5, 0.0, 0.0})};
  session.replace_loops(again);
  std::vector<std::pair<int, int>> found;
  for (const PoseEdge& edge : session.graph().edges()) {
    if (edge.robust) found.emplace_back(edge.from, edge.to);
  }
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{{0, 30}, {1, 40}, {2, 40}}));
}

TEST(GraphSession, TheWayIsUnconfirmedUntilTheMapConfirmsIt) {
  GraphSession session = driven(41);
  EXPECT_NEAR(session.unconfirmed_m(), 10.0, 1e-9);
  EXPECT_NEAR(session.travelled_m(40), 10.0, 1e-9);
  session.confirm_position();
  EXPECT_EQ(session.unconfirmed_m(), 0.0);
  EXPECT_NEAR(session.travelled_m(40), 10.0, 1e-9) << "it was driven all the same";
  EXPECT_GT(driven(41, 0.1).unconfirmed_m(), 11.0) << "turns count too";
  // Along a corridor each step is known to 0.3 m: 25 m for each that the way is off.
  EXPECT_GT(driven(41, 0.0, 0.3).unconfirmed_m(), 500.0);
  Keyframe after_break;
  after_break.new_segment = true;
  after_break.T_odom_base = {10.0, 0.0, 0.0};
  session.insert_node(after_break);
  EXPECT_GE(session.unconfirmed_m(), GraphSession::kBreakM);
}

TEST(GraphSession, AKeyframeThatShowsNothingNewStandsAtTheNearestNodeAndMovesWithIt) {
  GraphSession session = driven(41);
  Keyframe keyframe;
  keyframe.T_odom_base = {5.1, 0.2, 0.3};
  session.attach_to_node(keyframe, {5.1, 0.2, 0.3});
  EXPECT_EQ(session.submitted().back().node, 20);
  EXPECT_EQ(session.last_node(), 40) << "it is no node";
  keyframe.T_odom_base = {5.3, 0.2, 0.3};
  EXPECT_NEAR(session.predict(keyframe).x, 5.3, 1e-6) << "odometry goes on from where it stands";
}

}  // namespace
}  // namespace phasescan::graph_session_test
