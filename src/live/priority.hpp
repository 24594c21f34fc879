// Threads that wait for who tracks, where there are too few cores for both.
#pragma once

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace phasescan::live {

/// This thread is `steps` nicer than its process (0..19) from now on.
inline void be_nicer(int steps) {
  const int now = ::getpriority(PRIO_PROCESS, 0);
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), std::min(now + steps, 19));
}

}  // namespace phasescan::live
