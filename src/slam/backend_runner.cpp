#include "slam/backend_runner.hpp"

#include <utility>

#include "slam/finished_map.hpp"

namespace phasescan {

BackendRunner::BackendRunner(const SlamOptions& options, BackendState state, Schedule schedule, Executor* executor)
    : backend_(options, std::move(state)), schedule_(schedule), executor_(executor) {
  for (const PoseEdge& edge : backend_.graph().edges()) loop_enabled_.push_back(edge.robust && edge.enabled);
}

BackendRunner::~BackendRunner() {
  std::unique_lock lock(mutex_);
  queue_.clear();
  idle_.wait(lock, [this] { return !running_; });
}

void BackendRunner::submit(std::vector<Keyframe> batch, const Eigen::Matrix3d& odom_covariance) {
  if (schedule_ == Schedule::kDeterministic) {
    wait();
    entering_ = std::exchange(ready_, nullptr);
  }
  if (executor_ == nullptr) {
    work(std::move(batch), odom_covariance);
    return;
  }
  const std::lock_guard lock(mutex_);
  for (Keyframe& keyframe : batch) queue_.push_back(std::move(keyframe));
  queue_covariance_ = odom_covariance;
  if (running_) return;
  running_ = true;
  executor_->run([this] { drain(); });
}

void BackendRunner::drain() {
  for (;;) {
    std::vector<Keyframe> batch;
    Eigen::Matrix3d odom_covariance;
    {
      const std::lock_guard lock(mutex_);
      batch.swap(queue_);
      odom_covariance = queue_covariance_;
      if (batch.empty() || failure_) {
        // Told under the lock: the destructor may be waiting, and this object is gone once it is not.
        running_ = false;
        idle_.notify_all();
        return;
      }
    }
    try {
      work(std::move(batch), odom_covariance);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
  }
}

void BackendRunner::work(std::vector<Keyframe> batch, const Eigen::Matrix3d& odom_covariance) {
  backend_.add_batch(std::move(batch));
  auto result = make_result(odom_covariance);
  note_loops(*result);
  const std::lock_guard lock(mutex_);
  ready_ = std::move(result);
}

std::shared_ptr<BackendResult> BackendRunner::make_result(const Eigen::Matrix3d& odom_covariance) {
  auto result = std::make_shared<BackendResult>();
  result->snapshot = backend_.snapshot();
  result->odom_covariance = odom_covariance;
  return result;
}

void BackendRunner::note_loops(BackendResult& result) {
  const std::vector<PoseEdge>& edges = backend_.graph().edges();
  loop_enabled_.resize(edges.size(), 0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool now = edges[i].robust && edges[i].enabled;
    if (now == static_cast<bool>(loop_enabled_[i])) continue;
    loop_enabled_[i] = static_cast<char>(now);
    result.loops.emplace_back(map_edge(edges[i]), now);
  }
}

std::shared_ptr<const BackendResult> BackendRunner::final_result(const Eigen::Matrix3d& odom_covariance) {
  return make_result(odom_covariance);
}

std::shared_ptr<const BackendResult> BackendRunner::take() {
  if (schedule_ == Schedule::kDeterministic) return std::exchange(entering_, nullptr);
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return std::exchange(ready_, nullptr);
}

void BackendRunner::wait() {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [this] { return !running_; });
  if (failure_) std::rethrow_exception(failure_);
}

bool BackendRunner::at_rest() const {
  const std::lock_guard lock(mutex_);
  return !running_;
}

void BackendRunner::finish(std::vector<Keyframe> batch) {
  if (!batch.empty()) backend_.add_batch(std::move(batch));
  backend_.finish();
}

std::shared_ptr<const BackendResult> BackendRunner::pending() const {
  const std::lock_guard lock(mutex_);
  return ready_;
}

void BackendRunner::set_pending(std::shared_ptr<const BackendResult> result) {
  ready_ = std::move(result);
}

}  // namespace phasescan
