#include "slam/map_covariance.hpp"

#include <Eigen/LU>

#include "odometry/information.hpp"
#include "slam/edge_information.hpp"

namespace phasescan {
namespace {

// Standard deviations that a step or a match keeps whatever it claims to know [m], [rad].
constexpr double kOpenM = 1.0, kOpenRad = 0.5;

/// Of T_map_b = T_map_a * T_a_b from that of T_map_a, what lies between them known.
Eigen::Matrix3d carry(const Eigen::Matrix3d& covariance, const Pose2& T_map_a, const Pose2& T_map_b) {
  return carry_covariance(covariance, T_map_b.translation() - T_map_a.translation());
}

/// Adds an error in the frame of the pose itself.
Eigen::Matrix3d add_error(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& information, const Pose2& T_map_b) {
  return covariance + rotate_information(information.inverse(), T_map_b.theta);
}

Pose2 last_pose(const GraphSession& session) {
  const SubmittedKeyframe& last = session.submitted().back();
  return session.poses()[static_cast<std::size_t>(last.node)] * last.T_node_keyframe();
}

int first_of_piece(int node, const Connectivity& connectivity) {
  int first = 0;
  while (!connectivity.tied(first, node)) ++first;
  return first;
}

}  // namespace

void MapCovariance::inserted(const GraphSession& session, const Pose2& T_map_before) {
  if (session.last_node() == 0 || session.keyframes().back().new_segment) {
    state_.covariance.setZero();  // the first node of its piece
    return;
  }
  const Pose2 now = last_pose(session);
  state_.covariance =
      add_error(carry(state_.covariance, T_map_before, now), session.graph().edges().back().information, now);
}

void MapCovariance::attached(const GraphSession& session, const Connectivity& connectivity, const Pose2& T_map_before,
                             const Eigen::Matrix3d& step_information,
                             const std::optional<Eigen::Matrix3d>& match_information) {
  const Pose2 now = last_pose(session);
  const int node = session.submitted().back().node;
  if (match_information) {
    if (const auto there = of_node(node, session, connectivity)) {
      state_.covariance = add_error(carry(*there, session.poses()[static_cast<std::size_t>(node)], now),
                                    edge_information(*match_information, kOpenM, kOpenRad), now);
      return;
    }
  }
  state_.covariance =
      add_error(carry(state_.covariance, T_map_before, now), edge_information(step_information, kOpenM, kOpenRad), now);
}

void MapCovariance::optimized(const GraphSession& session, const Connectivity& connectivity) {
  if (session.submitted().empty()) return;
  const int node = session.submitted().back().node;
  const auto there = of_node(node, session, connectivity);
  if (there) state_.covariance = carry(*there, session.poses()[static_cast<std::size_t>(node)], last_pose(session));
}

std::optional<Eigen::Matrix3d> MapCovariance::of_node(int node, const GraphSession& session,
                                                      const Connectivity& connectivity) {
  const int fixed = first_of_piece(node, connectivity);
  const std::size_t edges = session.graph().edges().size();
  if (!factor_.marginals || factor_.optimisations != session.optimisations() || factor_.edges != edges ||
      factor_.fixed != fixed) {
    factor_.marginals.emplace(session.graph(), fixed);
    factor_.optimisations = session.optimisations();
    factor_.edges = edges;
    factor_.fixed = fixed;
  }
  return factor_.marginals->of(node);
}

}  // namespace phasescan
