// What a pose graph knows of one node: a block of the inverse of its normal equations.
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "graph/marginal_covariance.hpp"

namespace phasescan {
namespace {

/// Numbers the nodes that enabled edges tie to `fixed`, itself left out; -1 for all others.
int number_tied_nodes(const std::vector<PoseEdge>& edges, int fixed, std::vector<int>& number) {
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
  const int root = root_of(fixed);
  int count = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    const int node = static_cast<int>(k);
    number[k] = node != fixed && root_of(node) == root ? count++ : -1;
  }
  return count;
}

/// Derivatives of an edge's error by its two poses (see PoseEdge).
void edge_jacobians(const PoseEdge& edge, const Pose2& from, const Pose2& to, Eigen::Matrix3d& by_from,
                    Eigen::Matrix3d& by_to) {
  const double turn = from.theta + edge.T_from_to.theta, c = std::cos(turn), s = std::sin(turn);
  const double dx = to.x - from.x, dy = to.y - from.y;
  by_from << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0, 0, -1;
  by_to << c, s, 0, -s, c, 0, 0, 0, 1;
}

/// The normal equations of the numbered nodes at their present poses, lower triangle.
Eigen::SparseMatrix<double> normal_equations(const PoseGraph& graph, const std::vector<int>& number, int count) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.edges().size() * 24);
  const auto add_block = [&entries](int row, int col, const Eigen::Matrix3d& block) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        if (3 * row + r >= 3 * col + c) entries.emplace_back(3 * row + r, 3 * col + c, block(r, c));
      }
    }
  };
  for (const PoseEdge& e : graph.edges()) {
    if (!e.enabled) continue;
    const int a = number[static_cast<std::size_t>(e.from)], b = number[static_cast<std::size_t>(e.to)];
    if (a < 0 && b < 0) continue;
    Eigen::Matrix3d A, B;
    edge_jacobians(e, graph.poses()[static_cast<std::size_t>(e.from)], graph.poses()[static_cast<std::size_t>(e.to)], A,
                   B);
    if (a >= 0) add_block(a, a, A.transpose() * e.information * A);
    if (b >= 0) add_block(b, b, B.transpose() * e.information * B);
    if (a < 0 || b < 0) continue;
    const Eigen::Matrix3d across = A.transpose() * e.information * B;
    if (a > b)
      add_block(a, b, across);
    else
      add_block(b, a, across.transpose());
  }
  Eigen::SparseMatrix<double> H(3 * count, 3 * count);
  H.setFromTriplets(entries.begin(), entries.end());
  return H;
}

}  // namespace

struct MarginalCovariance::Impl {
  int fixed = 0;
  std::vector<int> number;  // of each node in the equations
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky;
  Eigen::MatrixXd unit;  // zero between calls
};

MarginalCovariance::MarginalCovariance(const PoseGraph& graph, int fixed) : impl_(std::make_unique<Impl>()) {
  const std::size_t nodes = graph.poses().size();
  if (fixed < 0 || static_cast<std::size_t>(fixed) >= nodes) {
    throw std::invalid_argument("graph.covariance: node " + std::to_string(fixed) + " fixed of " +
                                std::to_string(nodes) + " nodes");
  }
  Impl& m = *impl_;
  m.fixed = fixed;
  m.number.resize(nodes);
  const int count = number_tied_nodes(graph.edges(), fixed, m.number);
  if (count == 0) return;
  m.cholesky.compute(normal_equations(graph, m.number, count));
  m.unit = Eigen::MatrixXd::Zero(3 * count, 3);
}
MarginalCovariance::~MarginalCovariance() = default;
MarginalCovariance::MarginalCovariance(MarginalCovariance&&) noexcept = default;
MarginalCovariance& MarginalCovariance::operator=(MarginalCovariance&&) noexcept = default;

std::optional<Eigen::Matrix3d> MarginalCovariance::of(int node) {
  Impl& m = *impl_;
  if (node < 0 || static_cast<std::size_t>(node) >= m.number.size()) {
    throw std::invalid_argument("graph.covariance: node " + std::to_string(node) + " of " +
                                std::to_string(m.number.size()) + " nodes");
  }
  if (node == m.fixed) return Eigen::Matrix3d::Zero().eval();
  const int number = m.number[static_cast<std::size_t>(node)];
  if (number < 0 || m.cholesky.info() != Eigen::Success) return std::nullopt;
  m.unit.middleRows<3>(3 * number).setIdentity();
  const Eigen::MatrixXd columns = m.cholesky.solve(m.unit);
  m.unit.middleRows<3>(3 * number).setZero();
  const Eigen::Matrix3d block = columns.middleRows<3>(3 * number);
  if (!block.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(0.5 * (block + block.transpose()));
}

std::optional<Eigen::Matrix3d> PoseGraph::covariance(int node, int fixed) const {
  return MarginalCovariance(*this, fixed).of(node);
}

}  // namespace phasescan
