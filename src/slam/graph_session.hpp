/// The pose graph of a run: its nodes are keyframes, its edges steps of tracking and loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/pose_graph.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/slam/options.hpp"
#include "slam/keyframe.hpp"
#include "slam/keyframe_numbers.hpp"
#include "slam/loop_consistency.hpp"

namespace phasescan {

/// A keyframe that was submitted: it is a node, or stands relative to one that already shows the place.
struct SubmittedKeyframe {
  std::int32_t node = 0;
  float x = 0, y = 0, theta = 0;                 ///< T_node_keyframe
  float odom_x = 0, odom_y = 0, odom_theta = 0;  ///< T_odom_base

  Pose2 T_node_keyframe() const { return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(theta)}; }
  Pose2 T_odom_base() const {
    return {static_cast<double>(odom_x), static_cast<double>(odom_y), static_cast<double>(odom_theta)};
  }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("node", self.node);
    v("x", self.x);
    v("y", self.y);
    v("theta", self.theta);
    v("odom_x", self.odom_x);
    v("odom_y", self.odom_y);
    v("odom_theta", self.odom_theta);
  }
};

/// One of long ago, of which not all are kept.
struct OldKeyframe {
  std::int32_t number = 0;
  SubmittedKeyframe submitted;
};

struct GraphSessionState {
  static constexpr int kVersion = 1;
  std::vector<Keyframe> keyframes;  ///< of the nodes
  PoseGraph graph;
  std::vector<SubmittedKeyframe> submitted;  ///< from number first_submitted on
  std::vector<OldKeyframe> old_submitted;    ///< of those before, in order; none in what is saved
  std::int32_t first_submitted = 0;          ///< 0 in what is saved
  Pose2 T_odom_last;                         ///< T_odom_base of the keyframe submitted last
  std::vector<double> travelled_m;  ///< of each node: since the start, breaks of tracking counted as a long way
  double unconfirmed_m = 0.0;       ///< travelled since a loop or the map last showed where the robot is
  std::uint64_t optimisations = 0;
  int nodes_at_optimize = 0;
  std::size_t new_edges = 0;      ///< loops added since the last optimisation
  bool large_correction = false;  ///< one of them moves the map by more than loops.small_error_m
  std::vector<int> large_loops;   ///< edges that are out of reach of the robust kernel
  std::int32_t last_session = 0;  ///< of the keyframe submitted last

  /// How many were submitted, also those that are not kept.
  std::size_t submitted_count() const { return static_cast<std::size_t>(first_submitted) + submitted.size(); }
  /// Of the submitted ones.
  KeyframeNumbers numbers() const;
  /// Those that are kept are numbered from 0 on.
  void count_kept();

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("keyframes", self.keyframes);
    v("graph", self.graph);
    v("submitted", self.submitted);
    v("T_odom_last", self.T_odom_last);
    v("travelled_m", self.travelled_m);
    v("unconfirmed_m", self.unconfirmed_m);
    v("optimisations", self.optimisations);
    v("nodes_at_optimize", self.nodes_at_optimize);
    v("new_edges", self.new_edges);
    v("large_correction", self.large_correction);
    v("large_loops", self.large_loops);
    v("last_session", self.last_session);
  }
};

/// Nodes and edges go in, the poses of the nodes come out. Loops that the rest of the graph contradicts are taken out
/// again.
class GraphSession {
 public:
  /// Way that a break of tracking counts for [m]: after it the map may be off by as much as loops.most_drift allows.
  static constexpr double kBreakM = 100.0;
  /// The same of a new session, which may be anywhere: most_drift of it is more than any map measures.
  static constexpr double kSessionM = 1e5;

  explicit GraphSession(const LoopOptions& options, GraphSessionState state = {});

  /// A keyframe becomes a node, tied to the keyframe before by the step of tracking between them.
  /// @return the number of the node
  int insert_node(Keyframe keyframe);
  /// A keyframe that shows nothing new stands at the nearest node. @cost O(nodes)
  void attach_to_node(const Keyframe& keyframe, const Pose2& T_map_base);
  /// An accepted loop becomes an edge; it takes effect with the next optimisation.
  void add_loop(const Loop& loop);
  /// The map showed where the robot is.
  void confirm_position() { state_.unconfirmed_m = 0.0; }
  /// Where odometry alone puts the next keyframe on the map. There must be one before it.
  Pose2 predict(const Keyframe& keyframe) const;
  /// By the keyframe submitted last. There must be one.
  Pose2 T_map_odom() const;

  /// Takes the graph of another run in, whose numbers of scans and drives go on from those here: beside the map,
  /// tied to it by no more than a guess. What is known of the keyframe submitted last is the other's from then on.
  /// @return the number of its first node
  int append(GraphSessionState other);
  /// Moves nodes as one. @param moved  of each node whether it is one of them
  void move_nodes(const std::vector<char>& moved, const Pose2& T_after_before);

  /// At the end of a batch: optimises where a large correction waits, or loops and many nodes.
  /// @return whether poses and edges may have changed
  /// @cost about 20 us a node when it does
  bool optimize_if_due();
  /// Optimises now; loops that fit badly afterwards are undone, undone ones that fit again are taken back.
  void optimize(int max_iterations);
  /// Exchanges the loops of the graph for those of a pass over all nodes, and optimises. A loop to a node that the new
  /// ones do not reach stays: it may be all that holds a part of the map.
  void replace_loops(std::span<const Loop> loops);

  const std::vector<Keyframe>& keyframes() const { return state_.keyframes; }
  const PoseGraph& graph() const { return state_.graph; }
  const std::vector<Pose2>& poses() const { return state_.graph.poses(); }
  /// The newest of those submitted, all where none was forgotten.
  const std::vector<SubmittedKeyframe>& submitted() const { return state_.submitted; }
  std::size_t submitted_count() const { return state_.submitted_count(); }
  /// Forgets of the submitted keyframes before `recent` those that are not needed. The last one is always kept.
  /// @param needed  in order
  void keep_submitted(const std::vector<std::int32_t>& needed, std::int32_t recent);
  double travelled_m(int node) const { return state_.travelled_m[static_cast<std::size_t>(node)]; }
  /// The drive of the keyframe submitted last.
  std::int32_t last_session() const { return state_.last_session; }
  /// Whether a keyframe is of another drive than that.
  bool begins_session(const Keyframe& keyframe) const {
    return !state_.submitted.empty() && keyframe.session != state_.last_session;
  }
  bool crosses_sessions(const PoseEdge& edge) const {
    return state_.keyframes[static_cast<std::size_t>(edge.from)].session !=
           state_.keyframes[static_cast<std::size_t>(edge.to)].session;
  }
  double unconfirmed_m() const { return state_.unconfirmed_m; }
  int last_node() const { return static_cast<int>(state_.keyframes.size()) - 1; }
  /// How often it was optimised: between two times no pose of a node changes.
  std::uint64_t optimisations() const { return state_.optimisations; }
  const GraphSessionState& state() const { return state_; }

 private:
  void submit(const Keyframe& keyframe, int node, const Pose2& T_node_keyframe);
  Pose2 beside_the_map() const;
  void add_step(const Keyframe& keyframe, int node, const Pose2& step);
  /// Loops that agree and ask for a large correction are past the reach of the robust kernel: without it the graph is
  /// drawn there. Where steps of tracking would be off by more than they can be, these loops are taken out again.
  void optimise_without_kernel();
  void undo_contradicted();

  LoopOptions options_;
  GraphSessionState state_;
};

}  // namespace phasescan
