/// What readers of saved states have to know of the types of SLAM.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include "odometry/state_types.hpp"
#include "slam/slam_state.hpp"
#include "state/fields.hpp"

namespace phasescan {

template <>
struct StateFields<PackedCovariance> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("value", self.value);
  }
};

template <>
struct StateFields<TrackingDiagnostics> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("overlap", self.overlap);
    v("residual_m", self.residual_m);
    v("wide_search", self.wide_search);
    v("full_search", self.full_search);
    v("new_segment", self.new_segment);
    v("wheels", self.wheels);
  }
};

template <>
struct StateFields<ScanUpdate> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.stamp);
    v("scan", self.scan);
    v("status", self.status);
    v("repeated", self.repeated);
    v("T_odom_base", self.T_odom_base);
    v("odom_covariance", self.odom_covariance);
    v("T_map_odom", self.T_map_odom);
    v("map_version", self.map_version);
    v("map_covariance", self.map_covariance);
    v("twist", self.twist);
    v("keyframe", self.keyframe);
    v("diagnostics", self.diagnostics);
  }
};

template <>
struct StateFields<MapEdge> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("from", self.from);
    v("to", self.to);
    v("T_from_to", self.T_from_to);
    v("information", self.information);
    v("loop", self.loop);
    v("enabled", self.enabled);
  }
};

/// Its nodes are the first keyframes of the graph: they are put back once all is read.
template <>
struct StateFields<BackendSnapshot> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("version", self.version);
    v("optimisations", self.optimisations);
    v("poses", self.poses);
    v("loops", self.loops);
    v("of_node", self.pieces.of_node);
    v("count", self.pieces.count);
    v("largest", self.pieces.largest);
    v("submitted", self.submitted);
    v("T_map_odom", self.T_map_odom);
    v("covariance", self.covariance);
  }
};

template <>
struct StateFields<SnapshotLoop> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("from", self.from);
    v("to", self.to);
    v("enabled", self.enabled);
  }
};

template <>
struct StateFields<BackendResult> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("snapshot", self.snapshot);
    v("odom_covariance", self.odom_covariance);
    v("loops", self.loops);
  }
};

inline bool is_positive_definite(const Eigen::Matrix3d& m) {
  return m.allFinite() && m.llt().info() == Eigen::Success;
}

inline const char* state_problem(const StoredScan& scan) {
  return scan.is_sound() ? nullptr : "a scan whose beams cannot be unpacked";
}
inline const char* state_problem(const ScanKind& kind) {
  Scan scan;
  scan.geometry = kind.geometry;
  scan.time_increment = kind.time_increment;
  for (const float a : kind.angles) {
    if (!(std::abs(a) < 1e5F)) return "a scan whose beams lie nowhere";
  }
  return state_problem(scan);
}
inline const char* state_problem(const KeyframePoints& points) {
  return points.is_sound() ? nullptr : "points that cannot be unpacked";
}
inline const char* state_problem(const Keyframe& keyframe) {
  if (!keyframe.points || !is_near(keyframe.T_odom_base) || keyframe.scan < 0 || !keyframe.centre.allFinite())
    return "a keyframe without points or place";
  return nullptr;
}
inline const char* state_problem(const PoseGraph& graph) {
  const auto nodes = static_cast<int>(graph.poses().size());
  for (const Pose2& pose : graph.poses()) {
    if (!is_near(pose)) return "a node that is nowhere";
  }
  for (const PoseEdge& e : graph.edges()) {
    if (e.from < 0 || e.to < 0 || e.from >= nodes || e.to >= nodes || e.from == e.to || !is_near(e.T_from_to))
      return "an edge between nodes that are not there";
    if (!is_positive_definite(e.information)) return "an edge of which nothing is known";
  }
  return nullptr;
}
inline const char* state_problem(const PlaceIndex& index) {
  return index.is_sound() ? nullptr : "descriptors of places that are not of one number";
}
inline const char* state_problem(const Loop& loop) {
  return is_positive_definite(loop.information) && is_near(loop.T_from_to) ? nullptr
                                                                           : "a loop of which nothing is known";
}

}  // namespace phasescan
