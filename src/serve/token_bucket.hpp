// How often something may happen.
#pragma once

#include <algorithm>
#include <chrono>

namespace phasescan::serve {

class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;
  TokenBucket(double per_s, double burst) : per_s_(per_s), burst_(burst), have_(burst), last_(Clock::now()) {}
  bool take(Clock::time_point now = Clock::now()) {
    have_ = std::min(burst_, have_ + per_s_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (have_ < 1.0) return false;
    have_ -= 1.0;
    return true;
  }

 private:
  double per_s_, burst_, have_;
  Clock::time_point last_;
};

}  // namespace phasescan::serve
