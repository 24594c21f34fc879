#include "slam/map_pieces.hpp"

#include <algorithm>
#include <numeric>

namespace phasescan {

MapPieces find_pieces(std::span<const Keyframe> keyframes, const PoseGraph& graph) {
  std::vector<int> root(keyframes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto root_of = [&](int node) {
    while (root[static_cast<std::size_t>(node)] != node) {
      int& above = root[static_cast<std::size_t>(node)];
      above = root[static_cast<std::size_t>(above)];
      node = above;
    }
    return node;
  };
  for (const PoseEdge& edge : graph.edges()) {
    const bool ties = edge.robust ? edge.enabled : !keyframes[static_cast<std::size_t>(edge.to)].new_segment;
    if (!ties) continue;
    const int a = root_of(edge.from), b = root_of(edge.to);
    root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  MapPieces pieces;
  pieces.of_node.resize(keyframes.size());
  std::vector<std::size_t> sizes;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const int r = root_of(static_cast<int>(k));
    if (static_cast<std::size_t>(r) == k) {
      pieces.of_node[k] = pieces.count++;
      sizes.push_back(0);
    } else {
      pieces.of_node[k] = pieces.of_node[static_cast<std::size_t>(r)];
    }
    ++sizes[static_cast<std::size_t>(pieces.of_node[k])];
  }
  if (!sizes.empty()) pieces.largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  return pieces;
}

}  // namespace phasescan
