/// The parts of a run and how they work together; `Slam` is the door to it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "odometry/checked_tracker.hpp"
#include "odometry/own_body.hpp"
#include "slam/backend_runner.hpp"
#include "slam/input_check.hpp"
#include "slam/packed_records.hpp"
#include "slam/slam_state.hpp"

namespace phasescan {

struct Slam::Impl {
  static const SlamOptions& validated(const SlamOptions& options) {
    options.validate();
    return options;
  }
  Impl(const SlamOptions& o, Schedule when, Executor* beside)
      : options(validated(o)),
        schedule(when),
        executor(beside),
        tracker(o.odometry, {}, {}, o.match),
        runner(std::make_unique<BackendRunner>(o, BackendState{}, when, beside)),
        own_body(o.match) {}
  Impl(const SlamState::Data& s, const SlamOptions& o, Schedule when, Executor* beside)
      : options(validated(o)),
        schedule(when),
        executor(beside),
        tracker(o.odometry, s.odometry, s.suspects, o.match),
        runner(std::make_unique<BackendRunner>(o, s.backend, when, beside)),
        own_body(o.match),
        state(s) {
    // Tracker and runner hold these now: no second copy of keyframes and graph stays as old as the checkpoint.
    state.odometry = {};
    state.suspects = {};
    state.backend = {};
    runner->set_pending(std::move(state.pending));
  }

  ScanUpdate track(const RangeMeasurement& measurement, bool repeated);
  ScanUpdate track_scene(const RangeMeasurement& measurement, bool repeated);
  bool look_for_body(const RangeMeasurement& measurement, bool repeated);
  ScanUpdate begin_anew();
  void begin_session();
  void settle_all();
  std::shared_ptr<SlamState::Data> checkpoint();
  ScanUpdate repeat(const RangeMeasurement& measurement);
  void take_keyframes(const TrackerStep& step, const RangeMeasurement& measurement);
  void take_keyframe(const TrackedKeyframe& tracked, const KeptScan& scan);
  void take_first(const TrackedKeyframe& tracked);
  void settle(const SettledScan& settled);
  KeptScan keep_settled(const RangeMeasurement& measurement, ScanId scan);
  const KeptScan& keep(const RangeMeasurement& measurement);
  void record(const TrackerStep& step, const RangeMeasurement& measurement, const ScanUpdate& update);
  void hand_over();
  void hand_over_full_batch();
  void enter(std::shared_ptr<const BackendResult> result);
  ScanUpdate update_of(const TrackerStep& step, Stamp stamp) const;
  void report(ScanId scan, const std::vector<OddityNote>& notes) const;
  void take_note(ScanId scan, const OddityNote& note);

  bool bounded() const { return options.slam.bounded_memory; }
  /// Whether every scan is kept, and not the keyframes' alone.
  bool keeps_all() const { return options.slam.polish && !bounded(); }
  ScanId next_scan() const {
    return state.old.end() + static_cast<ScanId>(packed.size() + state.ledger.records.size());
  }
  /// Where in the ledger as it is held the record of a scan is. @pre it is none of those packed or thinned
  std::size_t record_of(ScanId scan) const { return static_cast<std::size_t>(scan - state.old.end()) - packed.size(); }
  /// What no later scan changes takes less room from then on.
  void settle_records();
  void pack_records();
  void thin_path();
  std::vector<ScanId> pinned_scans(const Backend& backend) const;
  void forget_keyframes();
  void count_kept();
  std::vector<ScanRecord> all_records() const;
  /// The first scan of the session.
  ScanId session_begin() const { return state.ledger.sessions.empty() ? 0 : state.ledger.sessions.back(); }

  SlamOptions options;
  Schedule schedule;
  Executor* executor;
  CheckedTracker tracker;
  std::unique_ptr<BackendRunner> runner;
  OwnBody own_body;
  SlamState::Data state;  // but for odometry and backend, which tracker and runner hold
  PackedRecords packed;   // of the first scans in bounded-memory mode: the ledger in `state` goes on after them
  SlamObserver* observer = nullptr;
  double backend_cpu_s = 0.0;
  std::size_t path_limit = 0;  // scans of long ago that are kept in bounded-memory mode; 0: all
  bool finished = false;
  KeptScan kept{-1, nullptr, nullptr};  // the measurement in work, once it was kept
};

}  // namespace phasescan
