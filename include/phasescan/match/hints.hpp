/// What else is known of a pair of scans.
#pragma once

#include <optional>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

struct MatchHints {
  std::optional<Pose2> guess;  ///< T_ref_scan to start from; none: any rotation, no guess
  Twist2 reference_twist;      ///< motion of the sensor during the reference scan, taken out of it
  Twist2 scan_twist;           ///< the same for the scan
};

}  // namespace phasescan
