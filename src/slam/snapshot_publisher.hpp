/// Makes snapshots after batches and hands them out to any thread.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "slam/backend_snapshot.hpp"
#include "slam/connectivity.hpp"
#include "slam/graph_session.hpp"

namespace phasescan {

class SnapshotPublisher {
 public:
  /// By the thread that works on batches. @cost a copy of poses and loops: about 0.1 ms for ten thousand nodes
  void publish(std::uint64_t version, const GraphSession& session, const Connectivity& connectivity,
               const Eigen::Matrix3d& covariance);
  /// By any thread; what was published last.
  std::shared_ptr<const BackendSnapshot> snapshot() const;

 private:
  void take_loops(const GraphSession& session);

  SnapshotNodes nodes_;
  std::vector<SnapshotLoop> loops_;
  std::size_t edges_ = 0;            // that loops_ were taken from
  std::uint64_t optimisations_ = 0;  // the same
  mutable std::mutex mutex_;         // guards what follows
  std::shared_ptr<const BackendSnapshot> published_ = std::make_shared<const BackendSnapshot>();
};

}  // namespace phasescan
