/// From what a log says to what tracking takes.
#pragma once

#include <utility>

#include "phasescan/io/log.hpp"
#include "phasescan/scan/range_measurement.hpp"

namespace phasescan {

/// An entry of a log as a measurement: upright, whichever way the laser is mounted.
inline RangeMeasurement to_measurement(LogEntry entry) {
  if (entry.flipped) entry.scan = mirrored_scan(entry.scan);
  return {std::move(entry.scan), std::move(entry.laser), entry.T_base_laser, entry.odometry};
}

}  // namespace phasescan
