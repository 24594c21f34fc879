// When packets were measured, from when they arrived: the computer is late by as much as it likes, never early.
#pragma once

#include "phasescan/core/time.hpp"

namespace phasescan::live {

/// Follows the earliest arrivals. A sensor says how far apart its packets are more evenly than USB adapters and a busy
/// computer deliver them: of what both say, the earlier time is right.
class PacketClock {
 public:
  /// @param observed   when the packet was sent, by its arrival
  /// @param elapsed_s  since the packet before, by the sensor's own account; NaN or below 0: unknown
  /// @return when it was sent, at most `observed`, not before the packet before
  Stamp at(Stamp observed, double elapsed_s);
  /// What the sensor counts from is lost: the next arrival is taken as it is.
  void reset() { known_ = false; }

 private:
  /// How long a second of the sensor's account is: over some seconds of arrivals that are not all late.
  void measure_rate(Stamp observed, double elapsed_s);

  bool known_ = false;
  Stamp last_ = 0;
  Stamp window_from_ = 0;
  double window_said_s_ = 0.0, window_s_ = 0.0, rate_ = 1.0;
};

}  // namespace phasescan::live
