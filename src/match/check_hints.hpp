/// The caller's part of a match, checked the same way for every matcher.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "phasescan/match/result.hpp"

namespace phasescan {

/// @throws std::invalid_argument naming the twist that is not finite.
inline void check_twist(const char* name, const Twist2& twist) {
  if (!std::isfinite(twist.vx) || !std::isfinite(twist.vy) || !std::isfinite(twist.omega))
    throw std::invalid_argument(std::string(name) + ": not finite");
}

/// @throws std::invalid_argument naming the hint that is not finite.
inline void check_hints(const MatchHints& hints) {
  if (hints.guess && !hints.guess->is_finite()) throw std::invalid_argument("hints.guess: not finite");
  check_twist("hints.reference_twist", hints.reference_twist);
  check_twist("hints.scan_twist", hints.scan_twist);
}

}  // namespace phasescan
