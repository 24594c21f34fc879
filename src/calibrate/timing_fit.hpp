/// How regularly scans come: rate, its wander, revolutions that never arrived.
#pragma once

#include <vector>

#include "phasescan/core/time.hpp"

namespace phasescan {

struct TimingFit {
  double rate_hz = 0.0;              ///< 0 = not known
  double wander = 0.0;               ///< standard deviation of a revolution's time, share of it
  double wander_s = 0.0;             ///< time constant of the wander; 0 = each revolution anew
  double lost_share = 0.0;           ///< how often a burst is missing before a scan
  int burst_min = 0, burst_max = 0;  ///< missing revolutions a burst; 0 = none
  std::size_t intervals = 0;
};

/// From stamps in the order of the log. Stamps that repeat or run backwards say nothing, gaps of more than 50
/// revolutions are pauses. What stamps are late by (it makes every second interval short) is no wander.
TimingFit fit_timing(const std::vector<Stamp>& stamps);

}  // namespace phasescan
