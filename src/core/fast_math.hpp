/// Approximations for inner loops: plain float arithmetic without tables or library calls, so that every CPU gives the
/// same value and compilers can vectorise them.
#pragma once

#include <cmath>
#include <cstdint>

namespace phasescan {

/// Direction of (x, y) in turns, [0, 1). Error below 3e-6 turns (0.001 deg); (0, 0) gives 0.
/// @source [Abramowitz64] 4.4.49 for atan on [0, 1], folded octants
inline float direction_turns(float x, float y) {
  const float ax = std::fabs(x), ay = std::fabs(y);
  const float big = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
  const float t = small / (big > 1e-20F ? big : 1e-20F);
  const float s = t * t;
  // atan(t) / (2 pi)
  float turns = t * (0.1591336F + s * (-0.0525688F + s * (0.0286703F + s * (-0.0135493F + s * 0.0033160F))));
  turns = ay > ax ? 0.25F - turns : turns;
  turns = x < 0.0F ? 0.5F - turns : turns;
  turns = y < 0.0F ? 1.0F - turns : turns;
  return turns >= 1.0F ? 0.0F : turns;
}

}  // namespace phasescan
