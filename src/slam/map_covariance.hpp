/// How well the map knows where the robot is.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "graph/marginal_covariance.hpp"
#include "phasescan/core/pose2.hpp"
#include "slam/connectivity.hpp"
#include "slam/graph_session.hpp"

namespace phasescan {

struct MapCovarianceState {
  static constexpr int kVersion = 1;
  /// Of (x, y, theta) of the keyframe submitted last, in the frame of the map, relative to the first node of its piece.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("covariance", self.covariance);
  }
};

/// Follows the covariance from keyframe to keyframe: from the graph where that was optimised or the map was matched,
/// else grown by the steps of tracking.
class MapCovariance {
 public:
  explicit MapCovariance(MapCovarianceState state = {}) : state_(state) {}

  /// The last edge of the graph is the step to the keyframe submitted last, a node. @param T_map_before  of the one
  /// before
  void inserted(const GraphSession& session, const Pose2& T_map_before);
  /// The keyframe submitted last stands at a node. @param match_information  of its match with the map, in its own
  /// frame; empty where tracking alone says where it stands
  /// @cost where the graph changed since: one factorisation (see MarginalCovariance)
  void attached(const GraphSession& session, const Connectivity& connectivity, const Pose2& T_map_before,
                const Eigen::Matrix3d& step_information, const std::optional<Eigen::Matrix3d>& match_information);
  /// Poses and loops changed. @cost one factorisation
  void optimized(const GraphSession& session, const Connectivity& connectivity);

  const MapCovarianceState& state() const { return state_; }

 private:
  std::optional<Eigen::Matrix3d> of_node(int node, const GraphSession& session, const Connectivity& connectivity);

  MapCovarianceState state_;
  struct Factor {  // a cache: follows from the graph
    std::uint64_t optimisations = 0;
    std::size_t edges = 0;
    int fixed = -1;
    std::optional<MarginalCovariance> marginals;
  } factor_;
};

}  // namespace phasescan
