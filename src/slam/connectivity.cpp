#include "slam/connectivity.hpp"

#include <algorithm>

namespace phasescan {

void Connectivity::add_node(int tied_to) {
  if (tied_to >= 0) {
    segment_of_node_.push_back(segment_of_node_[static_cast<std::size_t>(tied_to)]);
    return;
  }
  const int segment = static_cast<int>(piece_of_segment_.size());
  piece_of_segment_.push_back(segment);
  segment_of_node_.push_back(segment);
}

void Connectivity::tie(int a, int b) {
  const int first = std::min(piece_of(a), piece_of(b)), second = std::max(piece_of(a), piece_of(b));
  if (first == second) return;
  std::replace(piece_of_segment_.begin(), piece_of_segment_.end(), second, first);
}

void Connectivity::rebuild(std::span<const Keyframe> keyframes, const PoseGraph& graph) {
  segment_of_node_.clear();
  piece_of_segment_.clear();
  std::vector<int> tied_to(keyframes.size(), -1);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.robust || keyframes[static_cast<std::size_t>(edge.to)].new_segment) continue;
    tied_to[static_cast<std::size_t>(edge.to)] = edge.from;
  }
  for (const int from : tied_to) add_node(from);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.robust && edge.enabled) tie(edge.from, edge.to);
  }
}

MapPieces Connectivity::pieces() const {
  MapPieces pieces;
  pieces.of_node.reserve(segment_of_node_.size());
  std::vector<int> number(piece_of_segment_.size(), -1);
  std::vector<std::size_t> sizes;
  for (const int segment : segment_of_node_) {
    int& piece = number[static_cast<std::size_t>(piece_of_segment_[static_cast<std::size_t>(segment)])];
    if (piece < 0) {
      piece = pieces.count++;
      sizes.push_back(0);
    }
    pieces.of_node.push_back(piece);
    ++sizes[static_cast<std::size_t>(piece)];
  }
  if (!sizes.empty()) pieces.largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  return pieces;
}

}  // namespace phasescan
