#include "live/live_tasks.hpp"

#include <utility>

namespace phasescan::live {
namespace {

constexpr std::size_t kMostTasks = 64;  // people click; more than these are no person's

}  // namespace

LiveTasks::LiveTasks() : impl_(std::make_unique<Impl>()) {}
LiveTasks::~LiveTasks() = default;

bool LiveTasks::post(std::function<void()> task) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->over || impl_->waiting.size() >= kMostTasks) return false;
  impl_->waiting.push_back(std::move(task));
  return true;
}

void LiveRunAccess::run(LiveTasks& tasks) {
  std::deque<std::function<void()>> now;
  {
    const std::lock_guard lock(tasks.impl_->mutex);
    now.swap(tasks.impl_->waiting);
  }
  for (const auto& task : now) task();
}

void LiveRunAccess::end(LiveTasks& tasks) {
  {
    const std::lock_guard lock(tasks.impl_->mutex);
    tasks.impl_->over = true;
  }
  run(tasks);
}

}  // namespace phasescan::live
