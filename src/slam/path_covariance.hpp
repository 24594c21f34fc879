/// How far the map can be off between two nodes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "slam/graph_session.hpp"

namespace phasescan {

/// Covariance of the motion between any two nodes of the graph, along the way through it that is known best: steps of
/// tracking, and loops where they are surer. All other ways would only make it smaller. Edges are taken as independent.
/// It follows from the graph and is no state: every node hangs on one before it, with sums from the first node on.
class PathCovariance {
 public:
  /// Takes nodes, poses and loops as they stand. @cost O(nodes + edges), 0.1 us each
  void rebuild(const GraphSession& session);
  /// Takes in what is new since: nodes with their steps, and loops that came before the next node did. Later ones wait
  /// for rebuild(), since nodes hang on theirs already.
  void append(const GraphSession& session);
  /// Of T_from_to, error in the frame of `to`. @cost a few steps where both hang on one way, O(nodes) at worst
  Eigen::Matrix3d between(int from, int to) const;

 private:
  /// Sums over the edges of a way. The errors of single edges add up as variances, those that all have in common as
  /// they are.
  struct Sums {
    /// Covariance of (u, theta) in the map's frame: an edge's turn moves what lies ahead of it, and u is its shift as
    /// seen from the frame's origin.
    Eigen::Matrix3d single = Eigen::Matrix3d::Zero();
    /// (u, theta) of tracking that turns by one radian too much for each metre of its way.
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();
  };
  struct Node {
    int parent = -1;
    double length = 0.0;  ///< of the way from the first node in uncertainty [m^2]: what the choice of the way minimises
    Pose2 pose;           ///< on the map when it was taken in
    Sums sums = {};
  };
  void hang(const PoseEdge& edge, const GraphSession& session);
  const Node& node(int k) const { return nodes_[static_cast<std::size_t>(k)]; }

  std::vector<Node> nodes_;
  std::size_t edges_taken_ = 0;
};

}  // namespace phasescan
