/// Runs the back end's batches, inside the caller or beside it, and says when their results enter.
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "phasescan/slam/slam.hpp"
#include "slam/backend.hpp"
#include "slam/keyframe.hpp"
#include "slam/backend_snapshot.hpp"

namespace phasescan {

/// What a batch left: the map as the tracker's side sees it from then on. Immutable.
struct BackendResult {
  std::shared_ptr<const BackendSnapshot> snapshot;
  /// Of the pose in odom of the keyframe that the snapshot's covariance is of.
  Eigen::Matrix3d odom_covariance = Eigen::Matrix3d::Zero();
  /// Loops that entered the graph with this batch (true), or left it.
  std::vector<std::pair<MapEdge, bool>> loops;
};

/// Owns the back end. Everything here is called from one thread; the batches themselves run on the executor's.
class BackendRunner {
 public:
  BackendRunner(const SlamOptions& options, BackendState state, Schedule schedule, Executor* executor);
  ~BackendRunner();
  BackendRunner(const BackendRunner&) = delete;
  BackendRunner& operator=(const BackendRunner&) = delete;

  /// Hands the next keyframes over. kDeterministic: waits for the batch before, whose result may enter now.
  /// @param odom_covariance  of the last one's pose in odom
  void submit(std::vector<Keyframe> batch, const Eigen::Matrix3d& odom_covariance);
  /// The newest result that may enter and has not yet. @throws what went wrong in a batch
  std::shared_ptr<const BackendResult> take();
  /// Until nothing is in work. @throws what went wrong in a batch
  void wait();
  /// Whether nothing is in work: `wait` would not wait.
  bool at_rest() const;
  /// The last keyframes, worked on by the caller. @pre as idle()
  void finish(std::vector<Keyframe> batch);
  /// The back end, when nothing is in work. @pre wait() was called and nothing was submitted since
  Backend& idle() { return backend_; }
  /// The result that is ready but has not entered; kDeterministic only (part of a checkpoint).
  std::shared_ptr<const BackendResult> pending() const;
  void set_pending(std::shared_ptr<const BackendResult> result);
  /// What the back end holds now, as a result; without the loops that came or went, since the last pass of finish()
  /// exchanges them all. @pre as idle()
  std::shared_ptr<const BackendResult> final_result(const Eigen::Matrix3d& odom_covariance);

 private:
  std::shared_ptr<BackendResult> make_result(const Eigen::Matrix3d& odom_covariance);
  void note_loops(BackendResult& result);
  void work(std::vector<Keyframe> batch, const Eigen::Matrix3d& odom_covariance);
  void drain();

  Backend backend_;
  Schedule schedule_;
  Executor* executor_;
  std::vector<char> loop_enabled_;  // of each edge, as the last result had it
  mutable std::mutex mutex_;
  std::condition_variable idle_;
  bool running_ = false;
  std::vector<Keyframe> queue_;  // kLatest: waits for the batch in work
  Eigen::Matrix3d queue_covariance_ = Eigen::Matrix3d::Zero();
  std::shared_ptr<const BackendResult> ready_, entering_;
  std::exception_ptr failure_;
};

}  // namespace phasescan
