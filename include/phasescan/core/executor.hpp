/// Who does the work beside the caller. The library starts no thread by itself: what may run beside the caller is given
/// to an executor that the caller hands over.
#pragma once

#include <functional>
#include <memory>

namespace phasescan {

/// Runs tasks. The library gives it one task at a time and waits for it, where it must, by means of its own.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Runs `task` now or later, on any thread. Every task must be run, also when the executor ends.
  virtual void run(std::function<void()> task) = 0;
};

/// One thread that runs tasks in the order in which they came. Its destructor runs what is left and then joins. It must
/// live longer than what uses it.
class ThreadExecutor final : public Executor {
 public:
  ThreadExecutor();
  ~ThreadExecutor() override;
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;
  void run(std::function<void()> task) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
