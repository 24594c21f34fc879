// The other end of LiveTasks: the thread that tracks takes them.
#pragma once

#include <deque>
#include <mutex>

#include "phasescan/live/live.hpp"

namespace phasescan::live {

struct LiveTasks::Impl {
  std::mutex mutex;
  std::deque<std::function<void()>> waiting;
  bool over = false;
};

class LiveRunAccess {
 public:
  /// Does what waits. @throws what a task throws
  static void run(LiveTasks& tasks);
  /// Does what waits, and takes no more.
  static void end(LiveTasks& tasks);
};

}  // namespace phasescan::live
