/// What a pose graph knows of its nodes: blocks of the inverse of its normal equations.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "graph/pose_graph.hpp"

namespace phasescan {

/// The factor of the normal equations of the enabled edges at the present poses, without the robust kernel, while one
/// node is held where it is: factored once, asked often. Knows nothing of later changes of the graph.
class MarginalCovariance {
 public:
  /// @throws std::invalid_argument for a node that does not exist. @cost about 10 us a node for graphs of this kind
  explicit MarginalCovariance(const PoseGraph& graph, int fixed = 0);
  ~MarginalCovariance();
  MarginalCovariance(MarginalCovariance&&) noexcept;
  MarginalCovariance& operator=(MarginalCovariance&&) noexcept;

  /// Marginal covariance of a node's (x, y, theta) in the frame of the graph. Zero for the node that is held; empty
  /// where no enabled edges lead to it.
  /// @throws std::invalid_argument for a node that did not exist. @cost about 0.5 us a node of the graph
  std::optional<Eigen::Matrix3d> of(int node);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
