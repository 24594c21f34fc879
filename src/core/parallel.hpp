/// Loops on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace phasescan {

/// Calls work(worker) for worker = 0 .. workers - 1, each on a thread of its own, 0 on the calling one, and waits for
/// all. Where some throw, the exception of the lowest worker is thrown on.
template <class Work>
void run_workers(std::size_t workers, Work&& work) {
  std::vector<std::exception_ptr> failures(workers);
  const auto guarded = [&](std::size_t worker) {
    try {
      work(worker);
    } catch (...) {
      failures[worker] = std::current_exception();
    }
  };
  std::vector<std::jthread> threads;  // joined where starting one throws
  threads.reserve(workers);
  for (std::size_t worker = 1; worker < workers; ++worker) threads.emplace_back(guarded, worker);
  if (workers > 0) guarded(0);
  threads.clear();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

/// Calls work(i, worker) once for every i in [0, count), on up to `workers` threads; whichever is free takes the next
/// i. What work(i, ..) does must not depend on which worker does it, then the outcome does not depend on `workers`.
/// After an exception a worker takes no more; that of the lowest worker is thrown on.
template <class Work>
void parallel_for(std::size_t count, std::size_t workers, Work&& work) {
  std::atomic<std::size_t> next{0};
  run_workers(std::min(workers, std::max<std::size_t>(count, 1)), [&](std::size_t worker) {
    for (std::size_t i = next++; i < count; i = next++) work(i, worker);
  });
}

}  // namespace phasescan
