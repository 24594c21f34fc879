/// Where beams lie that a text states no angles for.
#pragma once

#include <string>

#include "phasescan/io/log.hpp"

namespace phasescan {

struct BeamFan {
  double angle_min = 0.0;
  double angle_increment = 0.0;  ///< negative for clockwise
};

/// Whether the user said anything of angles.
bool is_stated(const BeamGeometry& beams);

/// The fan of `count` beams: as the user says, a full turn from 0 where nothing is said. A field of 2 pi is a full
/// turn, its increment 2 pi / count; any other one ends with its last beam.
/// @throws std::invalid_argument where field of view and increment contradict each other, naming the flags
BeamFan fan_of(const BeamGeometry& beams, std::size_t count);

/// What `fan_of` took for granted, for people; empty where the user said all.
std::string assumed_of(const BeamGeometry& beams);

}  // namespace phasescan
