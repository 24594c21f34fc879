/// What a tracked scan leaves in a run: its record, its keyframes, what waits for the next scan.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "odometry/information.hpp"
#include "slam/slam_impl.hpp"

namespace phasescan {
namespace {

Keyframe to_keyframe(const TrackedKeyframe& tracked, ScanId scan) {
  Keyframe keyframe;
  keyframe.points = std::make_shared<const KeyframePoints>(*tracked.points);
  keyframe.T_odom_base = tracked.T_odom_base;
  keyframe.T_mid_stamp = tracked.T_mid_stamp;
  keyframe.information = tracked.information;
  keyframe.new_segment = tracked.new_segment;
  keyframe.twist = tracked.twist;
  keyframe.laser = tracked.laser;
  keyframe.T_base_laser = tracked.T_base_laser;
  keyframe.scan = scan;
  const MapPoints& points = *tracked.points;
  for (std::size_t i = 0; i < points.size(); ++i) keyframe.centre += Eigen::Vector2d(points.x[i], points.y[i]);
  if (points.size() > 0) keyframe.centre /= static_cast<double>(points.size());
  return keyframe;
}

/// Steps of the wheels that say something else than the scans.
std::size_t steps_off(const WheelCounts& wheels) {
  return wheels.slipped + wheels.reversed + wheels.jumped;
}

}  // namespace

ScanUpdate Slam::Impl::track(const RangeMeasurement& measurement, bool repeated) {
  if (repeated) return repeat(measurement);
  const ScanId scan = next_scan();
  const std::size_t wheels_off = steps_off(tracker.state().motion.wheels.counts);
  const CheckedStep checked = tracker.add(measurement);
  if (state.ledger.wheels_off < 0 && steps_off(tracker.state().motion.wheels.counts) > wheels_off)
    state.ledger.wheels_off = scan;
  const TrackerStep& step = checked.step;
  const std::int32_t keyframes_before = state.ledger.keyframes;
  for (const SettledScan& settled : checked.settled) settle(settled);
  if (checked.suspect) state.suspect_ids.push_back(scan);
  take_keyframes(step, measurement);
  hand_over_full_batch();
  if (std::shared_ptr<const BackendResult> result = runner->take()) enter(std::move(result));
  ScanUpdate update = update_of(step, measurement.scan.stamp);
  if (state.ledger.keyframes > keyframes_before) update.keyframe = state.ledger.keyframes - 1;
  record(step, measurement, update);
  state.last = update;
  return update;
}

ScanUpdate Slam::Impl::repeat(const RangeMeasurement& measurement) {
  ScanRecord again = state.ledger.records.back();
  again.stamp = measurement.scan.stamp;
  again.repeated = true;
  state.ledger.records.push_back(again);
  if (!bounded()) state.ledger.covariances.push_back(state.ledger.covariances.back());
  settle_records();
  if (keeps_all()) state.store.add(measurement.scan, measurement.T_base_laser);
  ScanUpdate update = state.last;
  update.stamp = measurement.scan.stamp;
  update.scan = next_scan() - 1;
  update.repeated = true;
  update.keyframe.reset();
  return update;
}

void Slam::Impl::take_keyframes(const TrackerStep& step, const RangeMeasurement& measurement) {
  for (const TrackedKeyframe& tracked : step.keyframes) {
    const bool of_this_scan = tracked.scan + 1 == tracker.state().scans;
    if (of_this_scan) {
      take_keyframe(tracked, keep(measurement));
    } else {
      take_first(tracked);
    }
  }
  if (step.keyframe) state.keyframe_covariance = step.covariance;
  // That of the first tracked scan comes with the next one, which tells how it was distorted.
  if (tracker.state().first && !state.first) state.first = keep(measurement);
}

void Slam::Impl::take_keyframe(const TrackedKeyframe& tracked, const KeptScan& scan) {
  Keyframe keyframe = to_keyframe(tracked, scan.scan);
  keyframe.stored = scan.stored;
  keyframe.own_scan = scan.own;
  keyframe.session = static_cast<std::int32_t>(state.ledger.sessions.size());
  if (keyframe.session > 0 && state.ledger.keyframes == state.session_keyframe) keyframe.new_segment = true;
  if (keyframe.new_segment) state.ledger.breaks.push_back(state.ledger.keyframes);
  if (observer) observer->on_keyframe(state.ledger.keyframes, tracked.T_odom_base, scan.scan);
  state.T_odom_keyframe = tracked.T_odom_base;
  ++state.ledger.keyframes;
  state.batch.push_back(std::move(keyframe));
}

/// The keyframe of the first tracked scan, now that its pose is known: scans up to here stand relative to it.
void Slam::Impl::take_first(const TrackedKeyframe& tracked) {
  state.old.stand_at(state.first->scan, state.ledger.keyframes, tracked.T_mid_stamp);
  const ScanId held = std::max(state.first->scan, state.old.end());
  for (std::size_t i = record_of(held); i < state.ledger.records.size(); ++i) {
    state.ledger.records[i].keyframe = state.ledger.keyframes;
    state.ledger.records[i].set(tracked.T_mid_stamp);
  }
  take_keyframe(tracked, *state.first);
  state.first.reset();
}

/// A scan that waited for the next one: a keyframe after all, or left out.
void Slam::Impl::settle(const SettledScan& settled) {
  const ScanId id = state.suspect_ids.front();
  state.suspect_ids.erase(state.suspect_ids.begin());
  for (const TrackedKeyframe& tracked : settled.step.keyframes)
    take_keyframe(tracked, keep_settled(settled.measurement, id));
  if (settled.step.keyframe) state.keyframe_covariance = settled.step.covariance;
  for (std::size_t i = record_of(id); i < state.ledger.records.size(); ++i) {
    ScanRecord& record = state.ledger.records[i];
    if (i > record_of(id) && !record.repeated) break;
    record.keyframe = state.ledger.keyframes > state.session_keyframe ? state.ledger.keyframes - 1 : -1;
    record.set(state.T_odom_keyframe.inverse() * settled.step.T_odom_stamp);
    record.status = settled.step.status;
    record.left_out = settled.left_out;
  }
  if (settled.left_out) {
    const OddityNote note{"bad scan", false, "a scan that fits neither the one before nor the one after; left out"};
    take_note(id, note);
  }
  hand_over_full_batch();
}

KeptScan Slam::Impl::keep_settled(const RangeMeasurement& measurement, ScanId scan) {
  if (bounded()) return {scan, nullptr, std::make_shared<const Scan>(measurement.scan)};
  // Where all scans are kept each has its own number in the store.
  const std::size_t index =
      keeps_all() ? static_cast<std::size_t>(scan) : state.store.add(measurement.scan, measurement.T_base_laser);
  return {scan, state.store.stored(index), nullptr};
}

/// The scan as keyframes have it.
const KeptScan& Slam::Impl::keep(const RangeMeasurement& measurement) {
  if (kept.scan == next_scan()) return kept;
  kept = {next_scan(), nullptr, nullptr};
  if (bounded()) {
    kept.own = std::make_shared<const Scan>(measurement.scan);
  } else {
    kept.stored = state.store.stored(state.store.add(measurement.scan, measurement.T_base_laser));
  }
  return kept;
}

void Slam::Impl::record(const TrackerStep& step, const RangeMeasurement& measurement, const ScanUpdate& update) {
  ScanRecord record;
  record.stamp = measurement.scan.stamp;
  record.keyframe = state.ledger.keyframes > state.session_keyframe ? state.ledger.keyframes - 1 : -1;
  record.set(state.T_odom_keyframe.inverse() * step.T_odom_stamp);
  record.status = step.status;
  if (keeps_all()) keep(measurement);
  state.ledger.records.push_back(record);
  if (!bounded())
    state.ledger.covariances.push_back(PackedCovariance::of(update.map_covariance.value_or(update.odom_covariance)));
  settle_records();
}

void Slam::Impl::hand_over() {
  const double before = thread_cpu_seconds();
  std::vector<Keyframe> batch;
  batch.swap(state.batch);
  runner->submit(std::move(batch), state.keyframe_covariance);
  backend_cpu_s += thread_cpu_seconds() - before;
}

void Slam::Impl::hand_over_full_batch() {
  if (state.batch.size() >= static_cast<std::size_t>(options.slam.batch_nodes)) hand_over();
}

void Slam::Impl::enter(std::shared_ptr<const BackendResult> result) {
  const Pose2 before = state.entered ? state.entered->snapshot->T_map_odom : Pose2{};
  state.entered = std::move(result);
  if (observer == nullptr) return;
  for (const auto& [edge, accepted] : state.entered->loops) observer->on_loop(edge, accepted);
  observer->on_correction(before, state.entered->snapshot->T_map_odom, state.entered->snapshot->version);
}

ScanUpdate Slam::Impl::update_of(const TrackerStep& step, Stamp stamp) const {
  ScanUpdate update;
  update.stamp = stamp;
  update.scan = next_scan();
  update.status = step.status;
  update.T_odom_base = step.T_odom_stamp;
  update.odom_covariance = step.covariance;
  update.twist = step.twist;
  update.diagnostics = step.diagnostics;
  if (!state.entered) return update;
  const BackendSnapshot& map = *state.entered->snapshot;
  update.T_map_odom = map.T_map_odom;
  update.map_version = map.version;
  // What the map knows of its newest keyframe, and what tracking added since.
  const Eigen::Matrix3d since = step.covariance - state.entered->odom_covariance;
  update.map_covariance = map.covariance + rotate_information(positive_part(since), map.T_map_odom.theta);
  return update;
}

void Slam::Impl::report(ScanId scan, const std::vector<OddityNote>& notes) const {
  if (observer == nullptr) return;
  for (const OddityNote& note : notes) observer->on_warning(scan, note.kind, note.what, note.damage);
}

/// What tracking found odd, beside what the input shows by itself.
void Slam::Impl::take_note(ScanId scan, const OddityNote& note) {
  note_oddity(state.input, note, scan);
  report(scan, {note});
}

}  // namespace phasescan
