/// What works behind the tracker: loops, pose graph, and the poses of the keyframes on the map.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "graph/pose_graph.hpp"
#include "odometry/local_map.hpp"
#include "slam/keyframe.hpp"
#include "slam/loop.hpp"
#include "slam/map_pieces.hpp"
#include "phasescan/slam/options.hpp"
#include "slam/place_search.hpp"

namespace phasescan {

/// How many loops there were.
struct LoopCounts {
  std::size_t compared = 0;  ///< pairs of visits that were matched
  std::size_t places = 0;    ///< found by what they look like, before they were compared
  std::size_t found = 0;     ///< matches good enough to be a loop
  std::size_t accepted = 0;  ///< believed, and not undone since
  std::size_t undone = 0;    ///< once accepted, taken out again because the graph contradicts them
  std::size_t outvoted = 0;  ///< never found company
  /// Loops of the graph now: at the end all keyframes meet their neighbours again, which is in none of the counts
  /// above.
  std::size_t in_graph = 0;
};

/// Owns keyframes, loops and the graph. While `add_batch` runs nobody else may touch it; its state depends on the
/// batches alone, never on when they are worked on.
class Backend {
 public:
  explicit Backend(const SlamOptions& options);

  /// Takes the next keyframes in, looks for loops of each, and moves the graph where that is due.
  void add_batch(std::vector<Keyframe> batch);
  /// The last words: a full optimisation, every keyframe compared with all its neighbours once more.
  void finish();

  /// Poses on the map of all keyframes that were handed in, in that order; in bounded-memory mode not every one became
  /// a node of the graph. With `odometry` as laser odometry saw them.
  std::vector<Pose2> handed_in_poses(bool odometry = false) const;
  std::size_t handed_in() const { return handed_.size(); }
  /// One of them. @param keyframe  below handed_in()
  Pose2 handed_in_pose(std::size_t keyframe) const {
    const Handed& h = handed_[keyframe];
    return graph_.poses()[static_cast<std::size_t>(h.node)] * h.T_node_keyframe();
  }

  /// The nodes of the graph.
  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  const std::vector<Pose2>& poses() const { return graph_.poses(); }
  const PoseGraph& graph() const { return graph_; }
  LoopCounts loop_counts() const;
  /// What of the graph hangs together.
  MapPieces pieces() const { return find_pieces(keyframes_, graph_); }
  /// The node that a keyframe which was handed in stands at.
  int node_of(std::size_t handed_in) const { return handed_[handed_in].node; }

  /// Builds the map of the surroundings of a node from up to `max_keyframes` keyframes that look at the same place.
  void build_surroundings(int node, std::size_t max_keyframes, LocalMap& map) const;

 private:
  void add_keyframe(Keyframe keyframe);
  /// Makes a node of a keyframe and looks for its loops.
  void take(Keyframe keyframe);
  void hand_in(int node, const Pose2& T_node_keyframe, const Pose2& T_odom);

  // Bounded memory (backend_bounded.cpp).
  /// What the map has at a place that a keyframe is thought to look from.
  struct Sight {
    int around = 0;      ///< nodes that look at the same from so near
    Pose2 pose;          ///< on the map; the guess where it does not fit
    double overlap = 0;  ///< share of the hits on the map; 0 where the match moves the guess too far
  };
  /// A place that looks like what a keyframe sees, elsewhere than it should be.
  struct Suspicion {
    Pose2 guess, pose;
    int node = 0;             ///< that shows the place
    std::size_t waiting = 0;  ///< which of the waiting keyframes
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  };
  void settle(Keyframe keyframe);
  void settle_waiting();
  void stand(const Keyframe& keyframe, const Pose2& pose);
  Sight look(const Keyframe& keyframe, const Pose2& guess);
  std::optional<Suspicion> recognise(const Keyframe& keyframe, const Pose2& guess);
  bool jump();
  bool join_waiting();
  Pose2 guess_of(const Keyframe& keyframe) const;
  const LocalMap& surroundings(int node);

  void find_loops(int node);
  void find_places(int node);
  void believe(const Loop& loop);
  /// The loops that a new one makes believable. Between pieces that nothing ties yet it takes more.
  std::vector<Loop> judged(LoopJudge& judge, const Loop& loop);
  int piece_of(int node) const;
  std::optional<Loop> compare(int from, int to, const Pose2& T_world_to, double uncertainty_m);
  std::vector<int> nearby_visits(int node, int max_other_end) const;
  void add_loop_edge(const Loop& loop);
  void optimize(int max_iterations);
  /// Loops that agree and ask for a large correction are past the reach of the robust kernel. The graph is drawn there
  /// without it; where that asks more of odometry's steps than they can be off, they are taken out again.
  void bend_to_large_loops();
  void undo_contradicted();
  void rematch_all();
  const LocalMap& visit_map(int anchor);

  /// Where a keyframe that was handed in stands: at a node, or relative to one that already shows the place.
  struct Handed {
    std::int32_t node = 0;
    float x = 0, y = 0, theta = 0;  // T_node_keyframe
    float odom_x = 0, odom_y = 0, odom_theta = 0;
    Pose2 T_node_keyframe() const {
      return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(theta)};
    }
  };

  SlamOptions options_;
  PoseGraph graph_;
  std::vector<Handed> handed_;
  Pose2 T_odom_last_;  // of the keyframe handed in last
  std::vector<Keyframe> keyframes_;
  // Breaks of tracking cut the way into segments; loops tie segments to pieces.
  std::vector<int> segment_;  // of each node
  std::vector<int> piece_;    // of each segment: another one that it hangs together with, or itself
  LoopJudge judge_;
  PlaceSearch places_;
  double way_of_place_m_ = 0.0;  // way_m_ where a place looked as the map has it
  std::vector<double> way_m_;    // of each node: driven since the start, breaks of tracking counted as a long way
  LoopCounts counts_;
  std::optional<LoopCounts> counts_before_rematch_;
  std::vector<std::pair<int, std::unique_ptr<LocalMap>>> map_cache_;
  std::size_t next_cached_ = 0;
  LocalMap surroundings_;  // bounded memory: of the node that scans stand at now
  int surroundings_of_ = -1;
  std::vector<Keyframe> waiting_;           // bounded memory: keyframes that do not fit the map where they should be
  std::vector<Suspicion> suspicions_;       // of those
  static constexpr double kBreakM = 100.0;  // way that a break of tracking counts for
  double since_fit_m_ = 0.0;                // way of those that waited since one fitted; from kBreakM on: lost
  std::size_t sure_nodes_ = 0;              // where lost: nodes from before that
  int nodes_at_optimize_ = 0;
  std::size_t new_edges_ = 0;
  bool large_correction_ = false;
  std::vector<int> large_loops_;  // edges that the next optimisation has to bend the graph to
  double since_loop_m_ = 0.0;     // way since the last loop that was believed
};

}  // namespace phasescan
