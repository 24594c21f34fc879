/// Which keyframes hang together: breaks of tracking that no loop bridges leave a map in pieces.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "graph/pose_graph.hpp"
#include "slam/keyframe.hpp"

namespace phasescan {

struct MapPieces {
  std::vector<int> of_node;  ///< the piece of each node, numbered in the order in which they begin
  int count = 0;
  int largest = 0;  ///< the piece with most nodes, of equals the first

  bool in_largest(std::size_t node) const { return of_node[node] == largest; }
};

/// Steps of tracking tie a keyframe to the one before, but not the first after a break; loops tie while they are
/// enabled.
MapPieces find_pieces(std::span<const Keyframe> keyframes, const PoseGraph& graph);

}  // namespace phasescan
