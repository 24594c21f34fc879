/// Loops: two visits of one place, matched, and the rule that decides which are accepted.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/slam/options.hpp"

namespace phasescan {

/// A match of keyframe `to` with the surroundings of the keyframe `from`.
struct Loop {
  int from = 0;
  int to = 0;
  Pose2 T_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  ///< of the error in the frame of `to`
  double overlap = 0.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("from", self.from);
    v("to", self.to);
    v("T_from_to", self.T_from_to);
    v("information", self.information);
    v("overlap", self.overlap);
  }
};

/// What a loop asks of the map: from where its end stands to where the loop puts it, frame of `to`.
inline Pose2 asked_correction(const Loop& loop, std::span<const Pose2> poses) {
  return poses[static_cast<std::size_t>(loop.to)].inverse() *
         (poses[static_cast<std::size_t>(loop.from)] * loop.T_from_to);
}

struct LoopConsistencyState {
  static constexpr int kVersion = 1;
  std::vector<Loop> waiting;  ///< in the order in which they came, at most 64
  std::size_t rejected = 0;   ///< never found as many others as it takes

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("waiting", self.waiting);
    v("rejected", self.rejected);
  }
};

/// What a loop that hardly moves the map needs.
enum class SmallLoops {
  kAccepted,        ///< nothing more
  kMustBeAgreedOn,  ///< as many others as any loop: where the map has the two ends is a guess
};

/// Decides which loops are accepted: at once those that hardly move the map, the others when enough of them, found near
/// each other, ask for the same correction. Bounded: a loop that no others agree with is forgotten.
class LoopConsistency {
 public:
  explicit LoopConsistency(const LoopOptions& options, LoopConsistencyState state = {})
      : options_(options), state_(std::move(state)) {}

  /// @param poses  of the nodes on the map, as they stand
  /// @return the loops that are accepted now, perhaps earlier ones as well; empty while it has to wait
  std::vector<Loop> add(const Loop& loop, std::span<const Pose2> poses, SmallLoops small = SmallLoops::kAccepted);

  /// Loops still waiting count as rejected from now on.
  void close();
  std::size_t rejected() const { return state_.rejected; }
  const LoopConsistencyState& state() const { return state_; }

 private:
  LoopOptions options_;
  LoopConsistencyState state_;
};

}  // namespace phasescan
