/// CPU time of the stages of a match.
#pragma once

#include "phasescan/core/time.hpp"
#include "phasescan/match/result.hpp"

namespace phasescan {

/// Adds the CPU time since the last call to a stage; each call costs one clock reading.
class StageClock {
 public:
  StageClock() : start_(thread_cpu_seconds()), last_(start_) {}
  void add_to(double& stage_ms) {
    const double now = thread_cpu_seconds();
    stage_ms += 1e3 * (now - last_);
    last_ = now;
  }
  /// The CPU time since the beginning, to a total.
  void add_all_to(double& total_ms) const { total_ms += 1e3 * (thread_cpu_seconds() - start_); }

 private:
  double start_, last_;
};

/// One clock for all stages of a match: a reading costs as much as a hundred hits.
struct MatchTimer {
  StageClock clock;
  MatchTimes ms;

  void end_of(double MatchTimes::*stage) { clock.add_to(ms.*stage); }
};

}  // namespace phasescan
