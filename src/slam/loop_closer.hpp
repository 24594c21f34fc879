/// Finds loops: earlier visits of the place that a new node shows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "phasescan/slam/options.hpp"
#include "slam/connectivity.hpp"
#include "slam/graph_session.hpp"
#include "slam/loop_consistency.hpp"
#include "slam/path_covariance.hpp"
#include "slam/place_search.hpp"
#include "slam/visit_maps.hpp"
#include "state/fields.hpp"

namespace phasescan {

struct LoopCloserState {
  static constexpr int kVersion = 1;
  LoopConsistencyState consistency;
  std::size_t compared = 0;  ///< pairs of visits that were matched
  std::size_t places = 0;    ///< of these, found by what they look like
  std::size_t found = 0;     ///< matches good enough to be a loop
  std::size_t weak = 0;      ///< of these, rejected at once: between pieces that nothing ties, with too little overlap
  std::size_t beyond = 0;    ///< of these, rejected at once: they ask for more than tracking can be off
  std::size_t alike = 0;     ///< of these, rejected at once: several places far from each other look the same
  double travelled_at_place_m = 0.0;  ///< of the last node at which a place looked as the map has it
  std::int32_t doubted = -1;          ///< the first node of which a loop was counted as beyond or alike, -1: none

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("consistency", self.consistency);
    v("compared", self.compared);
    v("places", self.places);
    v("found", self.found);
    v("weak", self.weak);
    v("beyond", self.beyond);
    v("alike", self.alike);
    v("travelled_at_place_m", self.travelled_at_place_m);
    visit_since(v, 3, "doubted", self.doubted);
  }
};

/// Chooses earlier visits near a node on the map, and places that look alike anywhere, matches them, and says which
/// loops are accepted. Reads the graph; the caller puts the loops into it.
class LoopCloser {
 public:
  explicit LoopCloser(const SlamOptions& options, LoopCloserState state = {});

  /// Before a batch of nodes: takes the graph as it stands, so that what follows hangs on it alone.
  void begin_batch(const GraphSession& session) { covariance_.rebuild(session); }
  /// The loops that are accepted now that `node`, the newest, is there; they tie their pieces in `connectivity`.
  /// @cost O(nodes) and up to loops.clusters_per_node + loops.place_candidates matches
  std::vector<Loop> search(int node, const GraphSession& session, PlaceSearch& places, Connectivity& connectivity);
  /// A loop that was found elsewhere. @return what is accepted with it
  std::vector<Loop> submit(const Loop& loop, const GraphSession& session, Connectivity& connectivity);
  /// With the map in place: every node is compared with its neighbours of all times, the later ones too.
  /// @cost O(nodes^2) distances and up to loops.clusters_per_node matches a node
  std::vector<Loop> search_all(const GraphSession& session, Connectivity& connectivity);
  /// A node whose neighbours in time are known, compared with the nodes before `limit`: of another run, which was there
  /// first. @param by_looks  wherever the map has them too. @param consistency  of all loops between the two
  std::vector<Loop> search_before(int node, int limit, bool by_looks, LoopConsistency& consistency,
                                  const GraphSession& session, PlaceSearch& places, Connectivity& connectivity);
  /// Takes over what another run counted; its loops that wait are rejected. @param first  number of its first node now
  void append(const LoopCloserState& other, int first);
  /// No more loops come: those that wait are rejected.
  void close() { consistency_.close(); }

  LoopCloserState state() const;
  /// Loops that were rejected since they agreed with too few others.
  std::size_t rejected_inconsistent() const { return state_.weak + consistency_.rejected(); }

 private:
  std::vector<Loop> accept(LoopConsistency& consistency, const Loop& loop, const GraphSession& session,
                           Connectivity& connectivity);
  /// A loop of a node proves nothing. @param count  one of those of the state
  void doubt(int node, std::size_t& count, std::size_t loops);
  /// Whether places that look alike would put one node far apart: then its looks prove nothing.
  bool one_of_several(const std::vector<Loop>& found, const std::vector<Pose2>& poses) const;
  /// Whether a loop asks for no more than what tracking and earlier loops leave open between its ends.
  bool within_drift(const Loop& loop, const GraphSession& session) const;
  std::vector<int> nearby_visits(int node, int max_other, const GraphSession& session,
                                 const Connectivity& connectivity) const;
  std::optional<Loop> compare(int other, int node, const Pose2& T_map_node, double uncertainty_m,
                              const GraphSession& session);
  void search_places(int node, const GraphSession& session, PlaceSearch& places, Connectivity& connectivity,
                     std::vector<Loop>& accepted);

  LoopOptions options_;
  LoopCloserState state_;  // but for its consistency
  LoopConsistency consistency_;
  PathCovariance covariance_;
  VisitMaps visit_maps_;
  MapPoints points_;  // of the node that is compared
};

}  // namespace phasescan
