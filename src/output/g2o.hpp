/// Pose graphs in g2o's text format.
#pragma once

#include <span>
#include <string>

#include "phasescan/slam/slam.hpp"

namespace phasescan {

/// VERTEX_SE2 per keyframe, FIX 0, EDGE_SE2 per enabled edge (information: upper triangle).
std::string format_g2o(std::span<const MapKeyframe> keyframes, std::span<const MapEdge> edges);

}  // namespace phasescan
