/// Time between scans as far as it can be trusted: stamps come in bursts, twice, backwards or after minutes.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "phasescan/core/time.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

struct ScanTiming {
  static constexpr double kMostPeriods = 15.0;  ///< that a motion is carried on over
  double periods = 1.0;     ///< how many usual scan periods have passed, 1..15; 1 where stamps say nothing sensible
  double period_s = 0.0;    ///< the usual period [s], 0 = not known yet
  double duration_s = 0.0;  ///< of the scan's turn [s], 0 = unknown
  bool gap = false;         ///< much more time has passed than tracking can bridge
  /// Stamps jitter too much to tell whether scans are missing: the time since the last scan, if it is so long that some
  /// may be, else 0 [s].
  double unsure_s = 0.0;
  bool unsteady = false;  ///< stamps jitter so much
  /// The time since the last scan where so many are missing that the motion before says little of where the robot is
  /// now, else 0 [s].
  double lost_s() const { return periods >= 4.0 && !gap ? periods * period_s : 0.0; }
};

/// What stamps have been like. Plain values.
struct ScanClock {
  std::optional<Stamp> last;
  std::vector<double> steps_s;  ///< the last positive steps, a ring
  std::size_t next = 0;         ///< where the ring goes on
  double period_s = 0.0, jitter_s = 0.0;
  std::size_t backwards = 0, repeated = 0, gaps = 0;  ///< how often each came

  ScanTiming add(const Scan& scan);

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("last", self.last);
    v("steps_s", self.steps_s);
    v("next", self.next);
    v("period_s", self.period_s);
    v("jitter_s", self.jitter_s);
    v("backwards", self.backwards);
    v("repeated", self.repeated);
    v("gaps", self.gaps);
  }
};

}  // namespace phasescan
