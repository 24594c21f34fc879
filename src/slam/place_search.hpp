/// Finds keyframes that look at the same place wherever the map has them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"
#include "phasescan/slam/options.hpp"
#include "slam/keyframe.hpp"
#include "slam/place_index.hpp"

namespace phasescan {

/// What a turn of 360 beams at keyframe `node` would see of its own hits and those of up to `back` keyframes before it:
/// in each direction the nearest. Beams in whose direction nothing was seen say nothing (kTooNear). Keyframes before a
/// break of tracking are left out.
/// @param poses  of all keyframes on the map
Scan view_at(std::span<const Keyframe> keyframes, std::span<const Pose2> poses, int node, int back);

/// An earlier keyframe whose view matched.
struct PlaceMatch {
  int node = 0;
  Pose2 T_node_query;
};

struct PlaceSearchState {
  static constexpr int kVersion = 1;
  PlaceIndex index;         ///< descriptors of views; they hold the map as it stood when each was taken in
  std::vector<int> nodes;   ///< of the places in the index
  std::size_t matched = 0;  ///< candidates that the matcher was asked about

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("index", self.index);
    v("nodes", self.nodes);
    v("matched", self.matched);
  }
};

/// The views of earlier keyframes by their descriptors, and a matcher without a guess to check what they suggest.
/// One object per thread.
class PlaceSearch {
 public:
  /// @param match  of the matches that verify a place
  explicit PlaceSearch(const LoopOptions& options, const MatchOptions& match = {}, PlaceSearchState state = {});
  ~PlaceSearch();
  PlaceSearch(PlaceSearch&&) noexcept;

  /// Takes the view at the newest keyframe in. With `search`, looks for earlier ones, at least min_nodes_apart before
  /// it, that show the same place: the nearest descriptors of different visits are matched with no guess, and what is
  /// the same place by `is_same_place` and holds the pose in both directions is returned, best first.
  /// @cost  0.1 ms and 0.1 us an earlier keyframe; 1 ms a candidate
  std::vector<PlaceMatch> add(std::span<const Keyframe> keyframes, std::span<const Pose2> poses, bool search);

  /// The same for a keyframe that is not among them and does not enter the index; what it sees alone is compared with
  /// the first `nodes` keyframes.
  std::vector<PlaceMatch> find(const Keyframe& query, std::span<const Keyframe> keyframes, std::span<const Pose2> poses,
                               std::size_t nodes);

  /// The same for a keyframe that is one of them and in the index, or would be: its view is compared with those of the
  /// first `nodes` keyframes. Empty for the keyframes that no view is taken of.
  std::vector<PlaceMatch> find_again(int node, std::span<const Keyframe> keyframes, std::span<const Pose2> poses,
                                     std::size_t nodes);
  /// Takes the places of another run in. @param first_node  the number of its first node here
  void append(const PlaceSearchState& other, int first_node);

  const PlaceSearchState& state() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace phasescan
