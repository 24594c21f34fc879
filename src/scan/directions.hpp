/// Directions of many vectors at once.
#pragma once

#include <cstddef>

namespace phasescan {

/// out[k] = direction_turns(x[k], y[k]), the same on every CPU.
/// @param count  a multiple of SurfaceBatch::kPadding
void fill_directions(const float* x, const float* y, std::size_t count, float* out);

}  // namespace phasescan
