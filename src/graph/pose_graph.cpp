#include "graph/pose_graph.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>

namespace phasescan {
namespace {

/// Whitened error of one edge with its derivatives.
class EdgeCost final : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  EdgeCost(const Pose2& T_from_to, const Eigen::Matrix3d& information) : measured_(T_from_to) {
    sqrt_information_ = information.llt().matrixU();
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const double *a = parameters[0], *b = parameters[1];
    const double turn = a[2] + measured_.theta, c = std::cos(turn), s = std::sin(turn);
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    // e_t = R_z^T (R_a^T (t_b - t_a) - t_z), e_theta = theta_b - theta_a - theta_z
    const double cz = std::cos(measured_.theta), sz = std::sin(measured_.theta);
    const Eigen::Vector3d e(c * dx + s * dy - (cz * measured_.x + sz * measured_.y),
                            -s * dx + c * dy - (-sz * measured_.x + cz * measured_.y),
                            wrap_angle(b[2] - a[2] - measured_.theta));
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = sqrt_information_ * e;
    if (!jacobians) return true;
    if (jacobians[0]) {
      Eigen::Matrix3d J;
      J << -c, -s, -s * dx + c * dy, s, -c, -c * dx - s * dy, 0, 0, -1;
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobians[0], 3, 3) = sqrt_information_ * J;
    }
    if (jacobians[1]) {
      Eigen::Matrix3d J;
      J << c, s, 0, -s, c, 0, 0, 0, 1;
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobians[1], 3, 3) = sqrt_information_ * J;
    }
    return true;
  }

 private:
  Pose2 measured_;
  Eigen::Matrix3d sqrt_information_;
};

/// SE(2) with the heading kept in (-pi, pi].
class HeadingManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 3; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    out[0] = x[0] + delta[0];
    out[1] = x[1] + delta[1];
    out[2] = wrap_angle(x[2] + delta[2]);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override { return identity(jacobian); }
  bool Minus(const double* y, const double* x, double* out) const override {
    out[0] = y[0] - x[0];
    out[1] = y[1] - x[1];
    out[2] = wrap_angle(y[2] - x[2]);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override { return identity(jacobian); }

 private:
  static bool identity(double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(jacobian, 3, 3).setIdentity();
    return true;
  }
};

using Block = std::array<double, 3>;

/// The Ceres problem of a graph; `blocks` holds its parameters and must outlive it.
struct GraphProblem {
  GraphProblem(const std::vector<Pose2>& poses, const std::vector<PoseEdge>& edges, double kernel_width)
      : kernel(kernel_width) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem = std::make_unique<ceres::Problem>(options);
    blocks.reserve(poses.size());
    for (const Pose2& p : poses) {
      blocks.push_back({p.x, p.y, p.theta});
      problem->AddParameterBlock(blocks.back().data(), 3, &manifold);
    }
    if (!blocks.empty()) problem->SetParameterBlockConstant(blocks[0].data());
    for (const PoseEdge& e : edges) {
      if (!e.enabled) continue;
      problem->AddResidualBlock(new EdgeCost(e.T_from_to, e.information), e.robust ? &kernel : nullptr,
                                blocks[static_cast<std::size_t>(e.from)].data(),
                                blocks[static_cast<std::size_t>(e.to)].data());
    }
  }
  HeadingManifold manifold;
  ceres::CauchyLoss kernel;
  std::vector<Block> blocks;
  std::unique_ptr<ceres::Problem> problem;
};

}  // namespace

int PoseGraph::add_node(const Pose2& pose) {
  if (!pose.is_finite()) throw std::invalid_argument("graph.node: a pose that is not finite");
  poses_.push_back(pose);
  return static_cast<int>(poses_.size()) - 1;
}

int PoseGraph::add_edge(const PoseEdge& edge) {
  const int n = static_cast<int>(poses_.size());
  if (edge.from < 0 || edge.to < 0 || edge.from >= n || edge.to >= n || edge.from == edge.to) {
    throw std::invalid_argument("graph.edge: from " + std::to_string(edge.from) + " to " + std::to_string(edge.to) +
                                " with " + std::to_string(n) + " nodes");
  }
  if (!edge.T_from_to.is_finite() || !edge.information.allFinite() || edge.information.llt().info() != Eigen::Success) {
    throw std::invalid_argument("graph.edge: pose or information not finite, or information not positive definite");
  }
  edges_.push_back(edge);
  return static_cast<int>(edges_.size()) - 1;
}

void PoseGraph::keep_edges(const std::vector<char>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (keep[i]) edges_[kept++] = edges_[i];
  }
  edges_.resize(kept);
}

Pose2 PoseGraph::edge_error(int edge) const {
  const PoseEdge& e = edges_[static_cast<std::size_t>(edge)];
  return e.T_from_to.inverse() *
         (poses_[static_cast<std::size_t>(e.from)].inverse() * poses_[static_cast<std::size_t>(e.to)]);
}

double PoseGraph::edge_chi2(int edge) const {
  const Pose2 e = edge_error(edge);
  const Eigen::Vector3d v(e.x, e.y, e.theta);
  return v.dot(edges_[static_cast<std::size_t>(edge)].information * v);
}

GraphSummary PoseGraph::optimize(const GraphOptions& options) {
  GraphSummary summary;
  if (poses_.size() < 2 || edges_.empty()) {
    summary.converged = true;
    return summary;
  }
  GraphProblem graph(poses_, edges_, options.kernel_width);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.relative_tolerance;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary report;
  ceres::Solve(solver, graph.problem.get(), &report);
  summary.iterations = static_cast<int>(report.iterations.size());
  summary.initial_cost = report.initial_cost;
  summary.final_cost = report.final_cost;
  if (!report.IsSolutionUsable()) return summary;
  summary.converged = report.termination_type == ceres::CONVERGENCE;
  for (std::size_t i = 0; i < poses_.size(); ++i)
    poses_[i] = {graph.blocks[i][0], graph.blocks[i][1], wrap_angle(graph.blocks[i][2])};
  return summary;
}

}  // namespace phasescan
