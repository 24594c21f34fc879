/// Which nodes hang together: breaks of tracking that no loop bridges leave a map in pieces.
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

/// Nodes in segments, segments in pieces. A step of tracking puts a node into the segment of the node that it was
/// measured from; the first node after a break begins a segment. Enabled loops tie segments to pieces. What is here
/// follows from the nodes and the edges of the graph: it is rebuilt, never saved.
class Connectivity {
 public:
  /// The next node. @param tied_to  the node that tracking ties it to; -1 for none
  void add_node(int tied_to);
  /// A loop between two nodes is accepted. @cost O(segments)
  void tie(int a, int b);
  /// From all nodes and edges: after loops were undone, taken back or replaced. @cost O(nodes + edges)
  void rebuild(std::span<const Keyframe> keyframes, const PoseGraph& graph);

  bool tied(int a, int b) const { return piece_of(a) == piece_of(b); }
  std::size_t segments() const { return piece_of_segment_.size(); }
  MapPieces pieces() const;

 private:
  int piece_of(int node) const {
    return piece_of_segment_[static_cast<std::size_t>(segment_of_node_[static_cast<std::size_t>(node)])];
  }
  std::vector<int> segment_of_node_;
  std::vector<int> piece_of_segment_;  // the first segment of the piece
};

}  // namespace phasescan
