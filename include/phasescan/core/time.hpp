/// Time: integer nanoseconds inside, seconds as double only at the edges; CPU clocks for the figures that are reported.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>

namespace phasescan {

/// Nanoseconds since the log's own epoch.
using Stamp = std::int64_t;

/// No stamp lies beyond (before 1824, after 2115): so the difference of any two is one as well.
inline constexpr double kMostStampSeconds = 4.6e9;

/// Nearest nanosecond; values beyond kMostStampSeconds, and NaN, give 0.
inline Stamp stamp_from_seconds(double seconds) {
  if (!(std::abs(seconds) < kMostStampSeconds)) return 0;
  const double whole = std::floor(seconds);
  return static_cast<Stamp>(whole) * 1'000'000'000 + static_cast<Stamp>(std::llround((seconds - whole) * 1e9));
}
inline double stamp_to_seconds(Stamp stamp) {
  return static_cast<double>(stamp) * 1e-9;
}

/// CPU time of the calling thread [s].
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// CPU time of all threads of the process [s].
inline double process_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace phasescan
