// Two maps become one: the other run's graph is put beside this one, and moved as a whole to where it belongs.
#include <algorithm>

#include "odometry/information.hpp"
#include "slam/backend.hpp"

namespace phasescan {
namespace {

constexpr int kPasses = 2;  // the second finds what came near only by the first
constexpr int kTieIterations = 15;
constexpr int kBatchNodes = 10;  // after which the graph is optimised where that is due

}  // namespace

void Backend::join(BackendState other) {
  const int first = session_.append(std::move(other.session));
  places_.append(other.places, first);
  closer_.append(other.loops, first);
  // Places that were recognised are told by poses on the other map as it lay; they are found again.
  other.admission.candidates.clear();
  other.admission.sure_nodes += static_cast<std::size_t>(first);
  admission_ = make_admission(options_, std::move(other.admission));
  covariance_ = MapCovariance(other.covariance);
  batches_ += other.batches;
  connectivity_.rebuild(session_.keyframes(), session_.graph());
  if (options_.loops.enabled && first > 0) tie_from(first);
  publisher_.publish(++batches_, session_, connectivity_, covariance());
}

/// Looks for places that nodes from `first` on share with those before.
void Backend::tie_from(int first) {
  LoopConsistency consistency(options_.loops);
  MapPieces pieces = connectivity_.pieces();
  for (int pass = 0; pass < kPasses; ++pass) {
    closer_.begin_batch(session_);
    for (int node = first; node <= session_.last_node(); ++node) {
      const bool by_looks = options_.loops.places && pieces.count > 1;
      const std::vector<Loop> loops =
          closer_.search_before(node, first, by_looks, consistency, session_, places_, connectivity_);
      const bool ties = std::any_of(loops.begin(), loops.end(), [&](const Loop& l) {
        return pieces.of_node[static_cast<std::size_t>(l.from)] != pieces.of_node[static_cast<std::size_t>(l.to)];
      });
      if (ties) move_piece_to(loops.front(), pieces);
      for (const Loop& loop : loops) session_.add_loop(loop);
      if (ties) session_.optimize(kTieIterations);
      if (!ties && (node % kBatchNodes != 0 || !session_.optimize_if_due())) continue;
      graph_changed();
      closer_.begin_batch(session_);
      pieces = connectivity_.pieces();
    }
  }
  consistency.close();
  session_.optimize(kTieIterations);
  graph_changed();
}

/// Puts the piece that began later where a loop says that it is: a graph is not drawn together over kilometres.
void Backend::move_piece_to(const Loop& loop, const MapPieces& before) {
  const Pose2 T_map_to = poses()[static_cast<std::size_t>(loop.from)] * loop.T_from_to;
  Pose2 T_after_before = T_map_to * poses()[static_cast<std::size_t>(loop.to)].inverse();
  int moves = before.of_node[static_cast<std::size_t>(loop.to)];
  if (const int from = before.of_node[static_cast<std::size_t>(loop.from)]; from > moves) {
    moves = from;
    T_after_before = T_after_before.inverse();
  }
  std::vector<char> moved(before.of_node.size(), 0);
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] = static_cast<char>(before.of_node[k] == moves);
  session_.move_nodes(moved, T_after_before);
}

void Backend::move_map(const Pose2& T_after_before) {
  session_.move_nodes(std::vector<char>(keyframes().size(), 1), T_after_before);
  covariance_ = MapCovariance({rotate_information(covariance(), T_after_before.theta)});
  publisher_.publish(batches_, session_, connectivity_, covariance());
}

}  // namespace phasescan
