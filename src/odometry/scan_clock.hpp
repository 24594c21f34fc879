/// Time between scans as far as it can be trusted: stamps come in bursts, twice, backwards or after minutes.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

struct ScanTiming {
  double periods = 1.0;     ///< how many usual scan periods have passed, 1..3; 1 where stamps say nothing sensible
  double period_s = 0.0;    ///< the usual period [s], 0 = not known yet
  double duration_s = 0.0;  ///< of the scan's turn [s], 0 = unknown
  bool gap = false;         ///< much more time has passed than tracking can bridge
};

class ScanClock {
 public:
  ScanTiming add(const Scan& scan);

  struct Counts {
    std::size_t backwards = 0, repeated = 0, gaps = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  std::optional<Stamp> last_;
  std::vector<double> steps_s_;  // the last positive steps, a ring
  std::size_t next_ = 0;
  double period_s_ = 0.0, jitter_s_ = 0.0;
  Counts counts_;
};

}  // namespace phasescan
