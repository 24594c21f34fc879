// What a pose graph knows of one node: a block of the inverse of its normal equations.
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <stdexcept>
#include <string>

#include "graph/pose_graph.hpp"

namespace phasescan {
namespace {

/// Numbers the nodes that enabled edges tie to `start`, `fixed` left out; -1 for all others.
/// @return false where `fixed` is not among them
bool number_tied_nodes(const std::vector<PoseEdge>& edges, int start, int fixed, std::vector<int>& number, int& count) {
  // Union of the ends of each edge: the root of a set is its smallest node.
  std::vector<int> above(number.size());
  for (std::size_t k = 0; k < above.size(); ++k) above[k] = static_cast<int>(k);
  const auto root_of = [&above](int node) {
    while (above[static_cast<std::size_t>(node)] != node) {
      int& up = above[static_cast<std::size_t>(node)];
      up = above[static_cast<std::size_t>(up)];
      node = up;
    }
    return node;
  };
  for (const PoseEdge& e : edges) {
    if (!e.enabled) continue;
    const int a = root_of(e.from), b = root_of(e.to);
    above[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  const int root = root_of(start);
  count = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    const int node = static_cast<int>(k);
    number[k] = node != fixed && root_of(node) == root ? count++ : -1;
  }
  return root_of(fixed) == root;
}

/// Derivatives of an edge's error by its two poses (see PoseEdge).
void edge_jacobians(const PoseEdge& edge, const Pose2& from, const Pose2& to, Eigen::Matrix3d& by_from,
                    Eigen::Matrix3d& by_to) {
  const double turn = from.theta + edge.T_from_to.theta, c = std::cos(turn), s = std::sin(turn);
  const double dx = to.x - from.x, dy = to.y - from.y;
  by_from << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0, 0, -1;
  by_to << c, s, 0, -s, c, 0, 0, 0, 1;
}

}  // namespace

std::optional<Eigen::Matrix3d> PoseGraph::covariance(int node, int fixed) const {
  const int n = static_cast<int>(poses_.size());
  if (node < 0 || node >= n || fixed < 0 || fixed >= n) {
    throw std::invalid_argument("graph.covariance: node " + std::to_string(node) + " with " + std::to_string(fixed) +
                                " fixed of " + std::to_string(n) + " nodes");
  }
  if (node == fixed) return Eigen::Matrix3d::Zero().eval();
  std::vector<int> number(poses_.size());
  int count = 0;
  if (!number_tied_nodes(edges_, node, fixed, number, count)) return std::nullopt;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(edges_.size() * 27);
  const auto add_block = [&entries](int row, int col, const Eigen::Matrix3d& block) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        if (3 * row + r >= 3 * col + c) entries.emplace_back(3 * row + r, 3 * col + c, block(r, c));
      }
    }
  };
  for (const PoseEdge& e : edges_) {
    if (!e.enabled) continue;
    const int a = number[static_cast<std::size_t>(e.from)], b = number[static_cast<std::size_t>(e.to)];
    if (a < 0 && b < 0) continue;
    Eigen::Matrix3d A, B;
    edge_jacobians(e, poses_[static_cast<std::size_t>(e.from)], poses_[static_cast<std::size_t>(e.to)], A, B);
    if (a >= 0) add_block(a, a, A.transpose() * e.information * A);
    if (b >= 0) add_block(b, b, B.transpose() * e.information * B);
    if (a >= 0 && b >= 0) {
      const Eigen::Matrix3d across = A.transpose() * e.information * B;
      if (a > b)
        add_block(a, b, across);
      else
        add_block(b, a, across.transpose());
    }
  }
  Eigen::SparseMatrix<double> H(3 * count, 3 * count);
  H.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky(H);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const int first = 3 * number[static_cast<std::size_t>(node)];
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(3 * count, 3);
  unit.middleRows<3>(first).setIdentity();
  const Eigen::Matrix3d block = cholesky.solve(unit).middleRows<3>(first);
  if (!block.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(0.5 * (block + block.transpose()));
}

}  // namespace phasescan
