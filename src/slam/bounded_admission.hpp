/// Admission that keeps the map small: keyframes that show nothing new become no nodes.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "odometry/local_map.hpp"
#include "slam/keyframe_admission.hpp"

namespace phasescan {

/// Memory grows with the area, not with time. A keyframe that fits the map well where it should be stands at a node.
/// One that does not waits until it is known whether the place is new or the tracker has slipped: other places that
/// look like what the waiting keyframes see must agree on a correction.
class BoundedAdmission final : public KeyframeAdmission {
 public:
  BoundedAdmission(const SlamOptions& options, AdmissionState state);

  /// @cost O(nodes), one match; one more for each place that looks alike where it waits
  void submit(Keyframe keyframe, const GraphSession& session, PlaceSearch& places) override;
  std::optional<Placement> next(const GraphSession& session) override;
  void close() override { admit_waiting(); }
  AdmissionState state() const override { return state_; }

 private:
  /// What the map has at a place that a keyframe is thought to look from.
  struct MapMatch {
    int around = 0;      ///< nodes that look at the same from so near
    Pose2 pose;          ///< on the map; as predicted where the keyframe does not fit
    double overlap = 0;  ///< share of the hits on the map; 0 where the match moves the prediction too far
    std::optional<Eigen::Matrix3d> information{};  ///< of `pose` in its own frame, where it is that of the match
  };
  /// A keyframe whose turn has come.
  struct Decision {
    Keyframe keyframe;
    enum Kind : std::uint8_t {
      kAttach,         ///< where `match` says
      kInsert,         ///< as a node
      kAttachOrInsert  ///< by how it fits the map then
    } kind = kInsert;
    MapMatch match;
    bool confirms_position = false;
    std::vector<Loop> recognised{};
  };

  void defer(Keyframe keyframe, const MapMatch& match, const Pose2& predicted, const GraphSession& session,
             PlaceSearch& places);
  Placement attach_or_insert(Keyframe keyframe, const GraphSession& session);
  /// All that wait are admitted one after the other.
  void admit_waiting();
  /// Where enough candidates agree on a correction, it is made.
  bool correct(const GraphSession& session);
  void relocalise_after_slip(const RelocalisationCandidate& last, const GraphSession& session);
  void close_loop_to_candidates(const GraphSession& session);
  std::optional<RelocalisationCandidate> recognise(const Keyframe& keyframe, const Pose2& predicted,
                                                   const GraphSession& session, PlaceSearch& places);
  MapMatch match_map(const Keyframe& keyframe, const Pose2& predicted, const GraphSession& session);
  const LocalMap& surroundings(int node, const GraphSession& session);
  bool lost() const { return state_.unfit_m >= GraphSession::kBreakM; }
  void lose(const GraphSession& session, bool new_session);

  SlamOptions options_;
  AdmissionState state_;
  std::deque<Decision> decided_;  // empty between keyframes
  MapPoints points_;              // of the keyframe that is matched
  struct Surroundings {           // a cache: follows from the graph
    int node = -1;
    std::size_t nodes = 0;
    std::uint64_t optimisations = 0;
    LocalMap map;
  } surroundings_;
};

}  // namespace phasescan
