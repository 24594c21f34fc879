/// The tracker, with scans that it cannot follow judged by the next one: a scan that fits neither neighbour is left
/// out.
#pragma once

#include <optional>
#include <vector>

#include "odometry/tracker.hpp"

namespace phasescan {

/// A scan that fits badly what came before it, while the next ones have not told whether it is bad or the robot moved.
struct SuspectScan {
  RangeMeasurement measurement;
  TrackerStep step;  ///< as if it were good

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("measurement", self.measurement);
    v("step", self.step);
  }
};

/// Plain values.
struct SuspectState {
  static constexpr int kVersion = 1;
  std::vector<SuspectScan> scans;       ///< in a row
  std::optional<OdometryState> before;  ///< as it was before the first of them

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scans", self.scans);
    v("before", self.before);
  }
};

/// What became of a suspect scan.
struct SettledScan {
  RangeMeasurement measurement;
  TrackerStep step;       ///< its pose comes from the neighbours where it was left out
  bool left_out = false;  ///< it fits neither neighbour; tracking went on from before it
};

/// What one scan brought, and what it told of those before.
struct CheckedStep {
  std::vector<SettledScan> settled;  ///< in order; each was suspect once, and those that are not settled still are
  TrackerStep step;
  bool suspect = false;  ///< the scan waits for the next one: its pose is not sure, and it is no keyframe yet
};

/// Deterministic, bounded: at most three scans in a row wait.
/// @cost where a scan waits, the next one is tracked twice
class CheckedTracker {
 public:
  explicit CheckedTracker(const OdometryOptions& options = {}, OdometryState state = {}, SuspectState suspects = {},
                          const MatchOptions& match = {})
      : tracker_(options, std::move(state), match), suspects_(std::move(suspects)) {}

  CheckedStep add(const RangeMeasurement& measurement);
  /// Scans that wait for a next one that does not come count as good.
  std::vector<SettledScan> finish();
  /// The keyframe of a log of one scan, where no second came.
  std::vector<TrackedKeyframe> first_keyframe() { return tracker_.finish(); }

  const OdometryState& state() const { return tracker_.state(); }
  const SuspectState& suspects() const { return suspects_; }

 private:
  CheckedStep add_after_suspects(const RangeMeasurement& measurement);
  void suspect(const RangeMeasurement& measurement, CheckedStep& out);
  void leave_out(const TrackerStep& next, std::vector<SettledScan>& settled);
  void accept(std::vector<SettledScan>& settled);

  Tracker tracker_;
  SuspectState suspects_;
};

}  // namespace phasescan
