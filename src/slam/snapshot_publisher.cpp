#include "slam/snapshot_publisher.hpp"

namespace phasescan {

void SnapshotPublisher::take_loops(const GraphSession& session) {
  const auto& edges = session.graph().edges();
  // Only an optimisation undoes loops or exchanges them.
  if (optimisations_ != session.optimisations()) {
    loops_.clear();
    edges_ = 0;
  }
  optimisations_ = session.optimisations();
  for (; edges_ < edges.size(); ++edges_) {
    const PoseEdge& e = edges[edges_];
    if (e.robust) loops_.push_back({e.from, e.to, e.enabled});
  }
}

void SnapshotPublisher::publish(std::uint64_t version, const GraphSession& session, const Connectivity& connectivity,
                                const Eigen::Matrix3d& covariance) {
  for (std::size_t i = nodes_.size(); i < session.keyframes().size(); ++i) {
    nodes_.push_back(node_of(session.keyframes()[i]));
  }
  take_loops(session);
  auto snapshot = std::make_shared<BackendSnapshot>();
  snapshot->version = version;
  snapshot->optimisations = session.optimisations();
  snapshot->nodes = nodes_;
  snapshot->poses = session.poses();
  snapshot->loops = loops_;
  snapshot->pieces = connectivity.pieces();
  snapshot->submitted = session.submitted_count();
  if (snapshot->submitted > 0) {
    snapshot->T_map_odom = session.T_map_odom();
    snapshot->last_session = session.last_session();
    snapshot->last_piece = snapshot->pieces.of_node[static_cast<std::size_t>(session.submitted().back().node)];
  }
  snapshot->covariance = covariance;
  const std::lock_guard lock(mutex_);
  published_ = std::move(snapshot);
}

std::shared_ptr<const BackendSnapshot> SnapshotPublisher::snapshot() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

}  // namespace phasescan
