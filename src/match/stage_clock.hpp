/// CPU time of the stages of a match.
#pragma once

#include "phasescan/core/time.hpp"

namespace phasescan {

/// Adds the CPU time since the last call to a stage; each call costs one clock reading.
class StageClock {
 public:
  StageClock() : last_(thread_cpu_seconds()) {}
  void add_to(double& stage_ms) {
    const double now = thread_cpu_seconds();
    stage_ms += 1e3 * (now - last_);
    last_ = now;
  }

 private:
  double last_;
};

}  // namespace phasescan
