/// What works behind the tracker: loops, pose graph, and the poses of the keyframes on the map.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "odometry/local_map.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/slam/options.hpp"
#include "phasescan/slam/result.hpp"
#include "slam/connectivity.hpp"
#include "slam/graph_session.hpp"
#include "slam/keyframe.hpp"
#include "slam/keyframe_admission.hpp"
#include "slam/backend_snapshot.hpp"
#include "slam/loop_closer.hpp"
#include "slam/map_covariance.hpp"
#include "slam/snapshot_publisher.hpp"
#include "slam/place_search.hpp"

namespace phasescan {

/// All that a back end knows between two batches. Plain values: a copy is a checkpoint. Local maps and the connectivity
/// follow from it and are not part of it.
struct BackendState {
  static constexpr int kVersion = 1;
  GraphSessionState session;
  PlaceSearchState places;
  LoopCloserState loops;
  AdmissionState admission;
  MapCovarianceState covariance;
  std::uint64_t batches = 0;                          ///< that were worked on
  std::optional<LoopCounts> counts_before_last_pass;  ///< those that are reported, once finish() looks for loops anew

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("session", self.session);
    v("places", self.places);
    v("loops", self.loops);
    v("admission", self.admission);
    v("covariance", self.covariance);
    v("batches", self.batches);
    v("counts_before_last_pass", self.counts_before_last_pass);
  }
};

/// Joins the parts: admission says which keyframes become nodes, the closer finds their loops, the session holds the
/// graph. While `add_batch` runs nobody else may touch it, but for `snapshot`; its state depends on the batches alone,
/// never on when they are worked on.
class Backend {
 public:
  explicit Backend(const SlamOptions& options, BackendState state = {});

  /// Takes the next keyframes in, looks for loops of each, and optimises the graph where that is due.
  /// @cost a few ms a keyframe; where the graph is optimised, about 20 us for each of its nodes on top
  void add_batch(std::vector<Keyframe> batch);
  /// Nothing comes that keyframes which wait could be judged by.
  void close_admission();
  /// Takes the map of another run in and ties it to this one where both show the same places, with no guess; what is
  /// not tied lies far beside. Afterwards this is the back end of the other run, with both maps.
  /// @param other  its scans and drives are numbered on from those here; nodes are not
  /// @cost 2 ms a node of the other, and an optimisation where they are tied
  void join(BackendState other);
  /// Moves the whole map. To be called between batches.
  void move_map(const Pose2& T_after_before);
  /// After the last batch: a full optimisation, every keyframe compared with all its neighbours once more.
  void finish();
  /// @return what a new back end needs to go on with the same bytes. @cost a copy of nodes, edges and descriptors
  BackendState state() const;
  /// The map after the last batch that is done; never null. Any thread may ask, at any time, also while a batch is
  /// worked on. @cost a lock that is held for two assignments
  std::shared_ptr<const BackendSnapshot> snapshot() const { return publisher_.snapshot(); }
  /// Of (x, y, theta) of the keyframe submitted last, in the frame of the map, relative to the first node of its piece.
  const Eigen::Matrix3d& covariance() const { return covariance_.state().covariance; }

  /// Poses on the map of all keyframes that were submitted, in that order; in bounded-memory mode not every one became
  /// a node of the graph. With `odometry` as laser odometry saw them.
  std::vector<Pose2> submitted_poses(bool odometry = false) const;
  std::size_t submitted() const { return session_.submitted_count(); }
  /// One of them. @param keyframe  below submitted(), none of long ago where keep_keyframes() was called
  Pose2 submitted_pose(std::size_t keyframe) const {
    const SubmittedKeyframe& k = submitted_keyframe(keyframe);
    return poses()[static_cast<std::size_t>(k.node)] * k.T_node_keyframe();
  }
  /// The node that a keyframe which was submitted stands at.
  int node_of(std::size_t submitted) const { return submitted_keyframe(submitted).node; }
  /// Forgets of the submitted keyframes before `recent` those that are not needed. To be called between batches.
  /// @param needed  in order. @return which are kept
  KeyframeNumbers keep_keyframes(const std::vector<std::int32_t>& needed, std::int32_t recent);
  /// Keyframes of which it is not known yet whether they become nodes.
  std::vector<Keyframe> waiting() const { return admission_->state().waiting; }

  /// The nodes of the graph.
  const std::vector<Keyframe>& keyframes() const { return session_.keyframes(); }
  const std::vector<Pose2>& poses() const { return session_.poses(); }
  const PoseGraph& graph() const { return session_.graph(); }
  const GraphSession& session() const { return session_; }
  LoopCounts loop_counts() const;
  /// The first node of which a loop was rejected as beyond drift or as one of places that look alike; -1: none.
  int doubted_node() const { return closer_.state().doubted; }
  /// What of the graph hangs together.
  MapPieces pieces() const { return connectivity_.pieces(); }

  /// Builds the map of the surroundings of a node from up to `max_keyframes` keyframes that look at the same place.
  void build_surroundings(int node, std::size_t max_keyframes, LocalMap& map) const;

 private:
  const SubmittedKeyframe& submitted_keyframe(std::size_t keyframe) const {
    return session_.submitted()[keyframe - static_cast<std::size_t>(session_.state().first_submitted)];
  }
  void place_admitted();
  void insert(Placement placement);
  void attach(const Placement& placement);
  void add_loops(std::span<const Loop> loops);
  void graph_changed();
  void tie_from(int first);
  void move_piece_to(const Loop& loop, const MapPieces& before);

  SlamOptions options_;
  GraphSession session_;
  Connectivity connectivity_;
  PlaceSearch places_;
  LoopCloser closer_;
  std::unique_ptr<KeyframeAdmission> admission_;
  MapCovariance covariance_;
  std::uint64_t batches_ = 0;
  std::optional<LoopCounts> counts_before_last_pass_;
  SnapshotPublisher publisher_;
};

}  // namespace phasescan
