// Which nodes hang together, while loops come, are undone and are taken back.
#include "slam/connectivity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"
#include "slam/graph_session.hpp"

namespace phasescan::connectivity_test {
namespace {

/// Keyframes of which some begin a segment, and a graph of steps.
struct Chain {
  std::vector<Keyframe> keyframes;
  PoseGraph graph;

  Chain(int nodes, const std::vector<int>& breaks) : keyframes(static_cast<std::size_t>(nodes)) {
    for (const int k : breaks) keyframes[static_cast<std::size_t>(k)].new_segment = true;
    for (int k = 0; k < nodes; ++k) {
      graph.add_node({});
      if (k > 0) graph.add_edge({k - 1, k, {}});
    }
  }
  int loop(int from, int to) {
    PoseEdge edge;
    edge.from = from;
    edge.to = to;
    edge.robust = true;
    return graph.add_edge(edge);
  }
};

TEST(Connectivity, BreaksThatNoLoopBridges) {
  Chain chain(6, {2, 4});
  Connectivity connectivity;
  connectivity.rebuild(chain.keyframes, chain.graph);
  EXPECT_EQ(connectivity.pieces().of_node, (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(connectivity.segments(), 3u);
  const int loop = chain.loop(3, 5);
  connectivity.tie(3, 5);
  const MapPieces tied = connectivity.pieces();
  EXPECT_EQ(tied.count, 2);
  EXPECT_EQ(tied.largest, 1);
  EXPECT_FALSE(tied.in_largest(0));
  EXPECT_TRUE(tied.in_largest(5));
  EXPECT_TRUE(connectivity.tied(2, 4));
  chain.graph.set_enabled(loop, false);
  connectivity.rebuild(chain.keyframes, chain.graph);
  EXPECT_EQ(connectivity.pieces().count, 3);
  EXPECT_FALSE(connectivity.tied(2, 4));
  connectivity.rebuild({}, {});
  EXPECT_EQ(connectivity.pieces().count, 0);
}

TEST(Connectivity, TheLargestPieceHasMostNodesAndOfEqualsIsTheFirst) {
  const auto largest = [](int nodes, const std::vector<int>& breaks) {
    const Chain chain(nodes, breaks);
    Connectivity connectivity;
    connectivity.rebuild(chain.keyframes, chain.graph);
    return connectivity.pieces().largest;
  };
  EXPECT_EQ(largest(6, {1, 4}), 1) << "of 1, 3 and 2 nodes";
  EXPECT_EQ(largest(6, {3}), 0) << "of 3 and 3";
  EXPECT_EQ(largest(6, {2}), 1) << "of 2 and 4";
}

TEST(Connectivity, StepByStepIsTheSameAsFromTheGraphAndAsPathsInIt) {
  Random random(17);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<Keyframe> keyframes;
    PoseGraph graph;
    Connectivity connectivity;
    for (int k = 0; k < 40; ++k) {
      keyframes.emplace_back();
      keyframes.back().new_segment = random.uniform(0.0, 1.0) < 0.2;
      graph.add_node({});
      // A step may begin at any node: in bounded memory a keyframe stands at one that has been there for long.
      const int from = k == 0 ? -1 : static_cast<int>(random.uniform(0.0, static_cast<double>(k)));
      if (k > 0) graph.add_edge({from, k, {}});
      connectivity.add_node(keyframes.back().new_segment ? -1 : from);
      if (k < 2 || random.uniform(0.0, 1.0) > 0.15) continue;
      const int other = static_cast<int>(random.uniform(0.0, static_cast<double>(k)));
      PoseEdge loop;
      loop.from = other, loop.to = k, loop.robust = true;
      graph.add_edge(loop);
      connectivity.tie(other, k);
    }
    Connectivity rebuilt;
    rebuilt.rebuild(keyframes, graph);
    EXPECT_EQ(rebuilt.pieces().of_node, connectivity.pieces().of_node);
    EXPECT_EQ(rebuilt.segments(), connectivity.segments());
    // Paths: label from each node along all edges that tie.
    std::vector<int> label(40);
    for (int k = 0; k < 40; ++k) label[static_cast<std::size_t>(k)] = k;
    for (bool changed = true; changed;) {
      changed = false;
      for (const PoseEdge& e : graph.edges()) {
        if (!e.robust && keyframes[static_cast<std::size_t>(e.to)].new_segment) continue;
        int &a = label[static_cast<std::size_t>(e.from)], &b = label[static_cast<std::size_t>(e.to)];
        if (a == b) continue;
        a = b = std::min(a, b);
        changed = true;
      }
    }
    for (int a = 0; a < 40; ++a) {
      for (int b = 0; b < a; ++b)
        EXPECT_EQ(rebuilt.tied(a, b), label[static_cast<std::size_t>(a)] == label[static_cast<std::size_t>(b)]);
    }
  }
}

}  // namespace
}  // namespace phasescan::connectivity_test
