/// What beams say where one surface ends before another: nothing, or something in between.
#pragma once

#include <cstddef>
#include <span>

#include "calibrate/beams.hpp"

namespace phasescan {

struct EdgeFit {
  double loss = 0.0;         ///< share of the beams lost at an edge
  double width_steps = 0.0;  ///< none from this distance on [beam steps]
  double mixed = 0.0;        ///< share of the answers beside an edge that lie between the two surfaces
  std::size_t edges = 0;
};

/// From edges between two smooth pieces of surface at least 30 cm apart.
EdgeFit fit_edges(std::span<const StopBeams> stops);

}  // namespace phasescan
