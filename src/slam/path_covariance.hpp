/// How far the map can be off between two nodes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "slam/graph_session.hpp"

namespace phasescan {

/// Sums over the edges of a way. The errors of single edges add up as variances, those that all have in common as they
/// are.
struct KnownWay {
  /// Covariance of (u, theta) in the map's frame: an edge's turn moves what lies ahead of it, and u is its shift as
  /// seen from the frame's origin.
  Eigen::Matrix3d single = Eigen::Matrix3d::Zero();
  /// (u, theta) of tracking that turns by one radian too much for each metre of its way.
  Eigen::Vector3d turning = Eigen::Vector3d::Zero();

  /// @param to    where the later end of the edge stands @param back  the way goes back along it
  void add(const PoseEdge& edge, const Eigen::Matrix3d& covariance, const Pose2& to, bool back);
  /// Of a pose at the end of the way, in the map's axes.
  Eigen::Matrix3d at(const Eigen::Vector2d& end) const;
};

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
  struct Node {
    int parent = -1;
    double length = 0.0;  ///< of the way from the first node in uncertainty [m^2]: what the choice of the way minimises
    Pose2 pose;           ///< on the map when it was taken in
    KnownWay sums = {};
  };
  void hang(const PoseEdge& edge, const GraphSession& session);
  const Node& node(int k) const { return nodes_[static_cast<std::size_t>(k)]; }

  std::vector<Node> nodes_;
  std::size_t edges_taken_ = 0;
};

/// Standard deviation of each node's position as seen from one of them [m]: along the way that is known best, back in
/// time as well, so that a loop found late makes known what lies before it. Infinite where no way leads.
/// @cost O(edges log edges)
std::vector<double> position_sigmas(const GraphSession& session, int seen_from);

}  // namespace phasescan
