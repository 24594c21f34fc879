#include "graph/pose_graph.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

#include "core/random.hpp"

namespace phasescan::pose_graph_test {
namespace {

Eigen::Matrix3d information(double metres, double radians) {
  return Eigen::Vector3d(1 / (metres * metres), 1 / (metres * metres), 1 / (radians * radians)).asDiagonal();
}

/// A drive around a square with exact steps.
std::vector<Pose2> square() {
  std::vector<Pose2> poses = {{1.0, 2.0, 0.4}};
  for (int i = 0; i < 40; ++i) poses.push_back(poses.back() * Pose2{0.5, 0.0, i % 10 == 9 ? kPi / 2 : 0.0});
  return poses;
}

TEST(PoseGraph, ExactMeasurementsBringEveryNodeHome) {
  const auto truth = square();
  Random random(4);
  PoseGraph graph;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Pose2 off{random.normal(0, 0.3), random.normal(0, 0.3), random.normal(0, 0.2)};
    graph.add_node(i == 0 ? truth[0] : truth[i] * off);
    if (i > 0)
      graph.add_edge(
          {static_cast<int>(i) - 1, static_cast<int>(i), truth[i - 1].inverse() * truth[i], information(0.05, 0.02)});
  }
  const GraphSummary summary = graph.optimize({100, 2.0, 1e-14});
  EXPECT_LT(summary.final_cost, 1e-10);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT(translation_distance(graph.poses()[i], truth[i]), 1e-5);
    EXPECT_LT(angle_distance(graph.poses()[i].theta, truth[i].theta), 1e-6);
  }
  EXPECT_EQ(graph.poses()[0].x, truth[0].x);
}

TEST(PoseGraph, TwoOpinionsMeetAtTheirWeightedMean) {
  // One node, two measurements along x with information 4 and 1: x = (4 * 1.0 + 1 * 2.0) / 5.
  PoseGraph graph;
  graph.add_node({0, 0, 0});
  graph.add_node({1.5, 0, 0});
  graph.add_edge({0, 1, {1.0, 0, 0}, Eigen::Vector3d(4, 4, 4).asDiagonal()});
  graph.add_edge({0, 1, {2.0, 0, 0}, Eigen::Vector3d(1, 1, 1).asDiagonal()});
  graph.optimize({100, 2.0, 1e-16});
  EXPECT_NEAR(graph.poses()[1].x, 1.2, 1e-7);
  const auto covariance = graph.covariance(1);
  ASSERT_TRUE(covariance);
  EXPECT_NEAR((*covariance)(0, 0), 1.0 / 5.0, 1e-6);
  EXPECT_NEAR((*covariance)(2, 2), 1.0 / 5.0, 1e-6);
}

/// The same by a dense inverse and numerical derivatives.
Eigen::Matrix3d dense_covariance(const PoseGraph& graph, int node, int fixed) {
  const auto n = static_cast<Eigen::Index>(graph.poses().size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  const double h = 1e-6;
  for (std::size_t e = 0; e < graph.edges().size(); ++e) {
    const PoseEdge& edge = graph.edges()[e];
    if (!edge.enabled) continue;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, 3 * n);
    for (const int end : {edge.from, edge.to}) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto error = [&](double step) {
          PoseGraph moved = graph;
          Pose2 p = graph.poses()[static_cast<std::size_t>(end)];
          (axis == 0 ? p.x : axis == 1 ? p.y : p.theta) += step;
          moved.set_pose(end, p);
          const Pose2 off = moved.edge_error(static_cast<int>(e));
          return Eigen::Vector3d(off.x, off.y, off.theta);
        };
        J.col(3 * end + axis) = (error(h) - error(-h)) / (2 * h);
      }
    }
    H += J.transpose() * edge.information * J;
  }
  H.block<3, 3>(3 * fixed, 3 * fixed) += 1e12 * Eigen::Matrix3d::Identity();
  const Eigen::MatrixXd inverse = H.inverse();
  return inverse.block<3, 3>(3 * node, 3 * node);
}

TEST(PoseGraph, CovarianceIsTheBlockOfTheDenseInverse) {
  Random random(21);
  const auto truth = square();
  PoseGraph graph;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    graph.add_node(truth[i]);
    if (i > 0)
      graph.add_edge({static_cast<int>(i) - 1, static_cast<int>(i), truth[i - 1].inverse() * truth[i],
                      information(random.uniform(0.01, 0.05), random.uniform(0.005, 0.02))});
  }
  graph.add_edge({2, 40, truth[2].inverse() * truth[40] * Pose2{0.02, 0.01, 0.003}, information(0.02, 0.01), true});
  const int undone = graph.add_edge({5, 30, {}, information(0.001, 0.001), true});
  graph.set_enabled(undone, false);
  for (const auto& [node, fixed] : {std::pair{40, 0}, {17, 0}, {0, 17}, {40, 30}, {3, 3}}) {
    const auto found = graph.covariance(node, fixed);
    ASSERT_TRUE(found);
    if (node == fixed) {
      EXPECT_EQ(found->norm(), 0.0);
      continue;
    }
    const Eigen::Matrix3d expected = dense_covariance(graph, node, fixed);
    EXPECT_LT((*found - expected).norm(), 1e-5 * expected.norm()) << node << " " << fixed;
    EXPECT_GT(expected(0, 0), 0.0);
  }
}

TEST(PoseGraph, CovarianceOfANodeThatNothingTiesIsEmptyAndSaysNothingOfTheOthers) {
  PoseGraph graph;
  for (int i = 0; i < 4; ++i) graph.add_node({static_cast<double>(i), 0, 0});
  graph.add_edge({0, 1, {1, 0, 0}, information(0.1, 0.1)});
  graph.add_edge({2, 3, {1, 0, 0}, information(0.1, 0.1)});
  EXPECT_FALSE(graph.covariance(3));
  EXPECT_NEAR((*graph.covariance(3, 2))(0, 0), 0.01, 1e-12);
  EXPECT_NEAR((*graph.covariance(1))(0, 0), 0.01, 1e-12);
  EXPECT_THROW(static_cast<void>(graph.covariance(4)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(graph.covariance(1, -1)), std::invalid_argument);
}

TEST(PoseGraph, ADisabledEdgeTiesNothing) {
  PoseGraph graph;
  for (int i = 0; i < 3; ++i) graph.add_node({static_cast<double>(i), 0, 0});
  graph.add_edge({0, 1, {1, 0, 0}, information(0.1, 0.1)});
  graph.set_enabled(graph.add_edge({1, 2, {1, 0, 0}, information(0.1, 0.1), true}), false);
  EXPECT_FALSE(graph.covariance(2));
  const auto tied = graph.covariance(1);
  ASSERT_TRUE(tied) << "what hangs on a disabled edge spoils nothing else";
  EXPECT_NEAR((*tied)(0, 0), 0.01, 1e-12);
}

TEST(PoseGraph, ErrorOfALoopIsSpreadEvenly) {
  // A chain of n equal steps along x, whose end is measured 0.1 m short with the information of one step: every step
  // gives way by the same amount, 0.1 / (n + 1).
  constexpr int n = 10;
  PoseGraph graph;
  for (int i = 0; i <= n; ++i) {
    graph.add_node({static_cast<double>(i), 0, 0});
    if (i > 0) graph.add_edge({i - 1, i, {1, 0, 0}, information(0.1, 0.1)});
  }
  graph.add_edge({0, n, {n - 0.1, 0, 0}, information(0.1, 0.1)});
  graph.optimize({50, 2.0, 1e-15});
  for (int i = 0; i <= n; ++i)
    EXPECT_NEAR(graph.poses()[static_cast<std::size_t>(i)].x, i * (1.0 - 0.1 / (n + 1)), 1e-8);
}

TEST(PoseGraph, GradientOfTheCostVanishesNumerically) {
  Random random(8);
  const auto truth = square();
  PoseGraph graph;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    graph.add_node(truth[i]);
    const Pose2 noise{random.normal(0, 0.02), random.normal(0, 0.02), random.normal(0, 0.01)};
    if (i > 0)
      graph.add_edge({static_cast<int>(i) - 1, static_cast<int>(i), truth[i - 1].inverse() * truth[i] * noise,
                      information(0.02, 0.01)});
  }
  graph.add_edge({0, 40, truth[0].inverse() * truth[40], information(0.01, 0.01)});
  graph.optimize({100, 2.0, 1e-16});
  const auto cost = [&](PoseGraph& g) {
    double sum = 0.0;
    for (std::size_t e = 0; e < g.edges().size(); ++e) sum += g.edge_chi2(static_cast<int>(e));
    return sum;
  };
  const double h = 1e-5;
  for (int node : {3, 17, 40}) {
    for (int axis = 0; axis < 3; ++axis) {
      PoseGraph up = graph, down = graph;
      Pose2 p = graph.poses()[static_cast<std::size_t>(node)], m = p;
      (axis == 0 ? p.x : axis == 1 ? p.y : p.theta) += h;
      (axis == 0 ? m.x : axis == 1 ? m.y : m.theta) -= h;
      up.set_pose(node, p);
      down.set_pose(node, m);
      EXPECT_NEAR((cost(up) - cost(down)) / (2 * h), 0.0, 2.0) << node << " " << axis;
    }
  }
}

TEST(PoseGraph, AWrongRobustLoopBarelyBendsTheGraphAndShowsInItsChi2) {
  const auto truth = square();
  PoseGraph graph;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    graph.add_node(truth[i]);
    if (i > 0)
      graph.add_edge(
          {static_cast<int>(i) - 1, static_cast<int>(i), truth[i - 1].inverse() * truth[i], information(0.02, 0.01)});
  }
  for (int k = 0; k < 3; ++k)
    graph.add_edge({k, 40 - k, truth[static_cast<std::size_t>(k)].inverse() * truth[static_cast<std::size_t>(40 - k)],
                    information(0.02, 0.01), true});
  const int wrong = graph.add_edge({5, 25, {0.1, 0.0, 0.0}, information(0.02, 0.01), true});
  graph.optimize({100, 2.0, 1e-12});
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT(translation_distance(graph.poses()[i], truth[i]), 0.25) << i;
  EXPECT_GT(graph.edge_chi2(wrong), 1000.0);
  graph.set_enabled(wrong, false);
  graph.optimize({100, 2.0, 1e-14});
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT(translation_distance(graph.poses()[i], truth[i]), 1e-4) << i;
}

TEST(PoseGraph, RefusesWhatIsNoEdge) {
  PoseGraph graph;
  graph.add_node({});
  graph.add_node({});
  EXPECT_THROW(graph.add_edge({0, 2, {}, Eigen::Matrix3d::Identity()}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({1, 1, {}, Eigen::Matrix3d::Identity()}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({0, 1, {}, Eigen::Matrix3d::Zero()}), std::invalid_argument);
  EXPECT_THROW(graph.add_edge({0, 1, {std::nan(""), 0, 0}, Eigen::Matrix3d::Identity()}), std::invalid_argument);
  EXPECT_THROW(graph.add_node({0, std::nan(""), 0}), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::pose_graph_test
