/// Pose graphs in g2o's text format.
#pragma once

#include <string>

#include "graph/pose_graph.hpp"

namespace phasescan {

/// VERTEX_SE2 per node, FIX 0, EDGE_SE2 per enabled edge (information: upper triangle).
std::string format_g2o(const PoseGraph& graph);

}  // namespace phasescan
