// A queue between two threads that never holds back who fills it: where it is full, the oldest goes and is counted.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

namespace phasescan::live {

template <class T>
class BoundedQueue {
 public:
  explicit BoundedQueue(std::size_t most) : most_(most) {}

  void push(T value) {
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (values_.size() >= most_) {
        values_.pop_front();
        ++dropped_;
      }
      values_.push_back(std::move(value));
    }
    filled_.notify_one();
  }

  /// The oldest; waits for one. Nothing once it is closed and empty.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    filled_.wait(lock, [this] { return closed_ || !values_.empty(); });
    if (values_.empty()) return std::nullopt;
    T value = std::move(values_.front());
    values_.pop_front();
    emptied_.notify_one();
    return value;
  }

  /// As pop, but waits no longer than this; then nothing, too.
  template <class Duration>
  std::optional<T> pop_within(Duration time) {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, time, [this] { return closed_ || !values_.empty(); });
    if (values_.empty()) return std::nullopt;
    T value = std::move(values_.front());
    values_.pop_front();
    emptied_.notify_one();
    return value;
  }

  bool empty() const {
    const std::lock_guard lock(mutex_);
    return values_.empty();
  }
  /// Closed, and all was taken.
  bool ended() const {
    const std::lock_guard lock(mutex_);
    return closed_ && values_.empty();
  }

  /// Waits a while for room; whether there is some.
  bool wait_for_room(std::chrono::milliseconds longest) {
    std::unique_lock lock(mutex_);
    return emptied_.wait_for(lock, longest, [this] { return closed_ || values_.size() < most_; });
  }

  /// Nothing more comes. What is in it can still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
  }

  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t most_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, emptied_;
  std::deque<T> values_;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace phasescan::live
