/// Pose graph on SE(2): nodes are poses, edges are measured relative poses with their information.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

/// What is known between two nodes. The error is e = (T_from_to^-1 * (X_from^-1 * X_to)) as (x, y, theta), as in g2o's
/// EDGE_SE2; `information` is the inverse covariance of e.
struct PoseEdge {
  int from = 0;
  int to = 0;
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  bool robust = false;  ///< may be wrong: large errors lose their weight (Cauchy kernel)
  bool enabled = true;  ///< disabled edges stay in the list and do not count

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("from", self.from);
    v("to", self.to);
    v("T_from_to", self.T_from_to);
    v("information", self.information);
    v("robust", self.robust);
    v("enabled", self.enabled);
  }
};

struct GraphOptions {
  int max_iterations = 20;
  double kernel_width = 2.0;         ///< of the robust kernel, in standard deviations
  double relative_tolerance = 1e-6;  ///< stop when the cost falls by less
};

struct GraphSummary {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
};

/// The graph. Node 0 is fixed; every further node should be tied to earlier ones by an enabled edge. A plain value:
/// what `visit` names is all there is.
class PoseGraph {
 public:
  static constexpr int kVersion = 1;
  int add_node(const Pose2& pose);
  /// @throws std::invalid_argument for a node that does not exist, an edge from a node to itself, a pose that is not
  /// finite, or an information matrix that is not finite or not positive definite.
  int add_edge(const PoseEdge& edge);
  void set_enabled(int edge, bool enabled) { edges_[static_cast<std::size_t>(edge)].enabled = enabled; }
  void set_pose(int node, const Pose2& pose) { poses_[static_cast<std::size_t>(node)] = pose; }
  void keep_edges(const std::vector<char>& keep);

  const std::vector<Pose2>& poses() const { return poses_; }
  const std::vector<PoseEdge>& edges() const { return edges_; }

  /// Error of an edge at the present poses, and its square weighted by the information (no kernel).
  Pose2 edge_error(int edge) const;
  double edge_chi2(int edge) const;

  /// Moves all nodes but the first to the least weighted squares [Grisetti10]; where the solver fails they stay.
  /// Deterministic: one thread, a fixed order.
  /// @cost sparse Cholesky per iteration: about 3 us a node for graphs of this kind
  GraphSummary optimize(const GraphOptions& options = {});

  /// Marginal covariance of one node while node `fixed` is held (see MarginalCovariance, which is asked for several).
  /// @throws std::invalid_argument for a node that does not exist.
  std::optional<Eigen::Matrix3d> covariance(int node, int fixed = 0) const;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("poses", self.poses_);
    v("edges", self.edges_);
  }

 private:
  std::vector<Pose2> poses_;
  std::vector<PoseEdge> edges_;
};

}  // namespace phasescan
