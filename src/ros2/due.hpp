/// What is done by time.
#pragma once

#include <optional>

#include "phasescan/core/time.hpp"

namespace phasescan::ros2 {

/// Diagnostics are sent so often; without scans for so long they say so.
inline constexpr double kDiagnosticsPeriod_s = 1.0, kNoScans_s = 2.0;

/// Whether something that was last done at `last` is to be done again. A clock that was set back is a reason to begin
/// anew, not to wait until it has caught up.
inline bool due(std::optional<Stamp> last, Stamp now, double period_s) {
  return !last || now < *last || stamp_to_seconds(now - *last) >= period_s;
}

}  // namespace phasescan::ros2
