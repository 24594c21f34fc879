// The two clocks of a live run: one to wait by, one to stamp with.
#pragma once

#include <chrono>
#include <cstdint>

#include "phasescan/core/time.hpp"

namespace phasescan::live {

/// Never jumps; from any moment on.
inline std::int64_t steady_ns() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}
/// What people set: arrivals are told in it.
inline Stamp system_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace phasescan::live
