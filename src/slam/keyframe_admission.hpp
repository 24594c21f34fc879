/// Which keyframes become nodes of the graph.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "phasescan/slam/options.hpp"
#include "slam/graph_session.hpp"
#include "slam/keyframe.hpp"
#include "slam/loop_consistency.hpp"
#include "slam/place_search.hpp"

namespace phasescan {

/// What is to be done with a keyframe.
struct Placement {
  Keyframe keyframe;
  std::optional<Pose2> attach_at;  ///< it stands at a node, with this pose on the map; empty: it becomes a node
  bool confirms_position = false;  ///< the map shows where the robot is
  std::vector<Loop> recognised{};  ///< loops of the new node that come with it; `to` is not filled in
  /// Of the match that found `attach_at`, in the keyframe's own frame; empty where tracking alone says it.
  std::optional<Eigen::Matrix3d> match_information{};
};

/// A place that looks like what a waiting keyframe sees, elsewhere than it should be.
struct RelocalisationCandidate {
  Pose2 predicted, pose;    ///< on the map: by odometry, and where the place says that the robot is
  int node = 0;             ///< that shows the place
  std::size_t waiting = 0;  ///< which of the waiting keyframes
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< of `pose`, in its own frame

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("predicted", self.predicted);
    v("pose", self.pose);
    v("node", self.node);
    v("waiting", self.waiting);
    v("information", self.information);
  }
};

/// State between two keyframes; empty where all keyframes become nodes.
struct AdmissionState {
  static constexpr int kVersion = 1;
  std::vector<Keyframe> waiting;  ///< keyframes that do not fit the map where they should be
  std::vector<RelocalisationCandidate> candidates;
  double unfit_m = 0.0;        ///< travelled by those that waited since one fitted; from GraphSession::kBreakM on: lost
  std::size_t sure_nodes = 0;  ///< where lost: nodes from before that

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("waiting", self.waiting);
    v("candidates", self.candidates);
    v("unfit_m", self.unfit_m);
    v("sure_nodes", self.sure_nodes);
  }
};

/// Takes keyframes and says one after the other what becomes of them. Each Placement that `next` returns is to be
/// carried out before the next call: later ones depend on it.
class KeyframeAdmission {
 public:
  virtual ~KeyframeAdmission() = default;
  /// May defer it, or decide about earlier ones as well. To be called when `next` has nothing more.
  virtual void submit(Keyframe keyframe, const GraphSession& session, PlaceSearch& places) = 0;
  virtual std::optional<Placement> next(const GraphSession& session) = 0;
  /// No more keyframes come: decides about all that wait.
  virtual void close() {}
  virtual AdmissionState state() const { return {}; }
};

/// The one that slam.bounded_memory asks for.
std::unique_ptr<KeyframeAdmission> make_admission(const SlamOptions& options, AdmissionState state = {});

/// Every keyframe becomes a node.
class AppendAdmission final : public KeyframeAdmission {
 public:
  void submit(Keyframe keyframe, const GraphSession& session, PlaceSearch& places) override;
  std::optional<Placement> next(const GraphSession& session) override;

 private:
  std::optional<Keyframe> submitted_;
};

}  // namespace phasescan
