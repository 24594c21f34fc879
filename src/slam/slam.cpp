#include "phasescan/slam/slam.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "odometry/information.hpp"
#include "slam/finished_map.hpp"
#include "slam/map_view.hpp"
#include "slam/result_parts.hpp"
#include "slam/run_judge.hpp"
#include "slam/slam_impl.hpp"
#include "slam/trajectory_refinement.hpp"

namespace phasescan {
namespace {

constexpr double kMostAheadS = 1.0;  // [s] that predict() looks from the last scan

void check(const RangeMeasurement& measurement) {
  if (!measurement.T_base_laser.is_finite()) throw std::invalid_argument("measurement.T_base_laser: not finite");
  if (measurement.T_odom_base && !measurement.T_odom_base->is_finite())
    throw std::invalid_argument("measurement.T_odom_base: not finite");
}

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
  pack_records();
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
  for (std::size_t i = record_of(state.first->scan); i < state.ledger.records.size(); ++i) {
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
  pack_records();
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

Slam::Slam(const SlamOptions& options, Schedule schedule, Executor* executor)
    : impl_(std::make_unique<Impl>(options, schedule, executor)) {}
Slam::Slam(const SlamState& state, const SlamOptions& options, Schedule schedule, Executor* executor)
    : impl_(std::make_unique<Impl>(state.data(), options, schedule, executor)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

ScanUpdate Slam::add(const RangeMeasurement& measurement) {
  Impl& self = *impl_;
  if (self.finished) throw std::logic_error("Slam::add: the run is finished");
  check(measurement);
  self.backend_cpu_s = 0.0;
  const ScanId scan = self.next_scan();
  const InputVerdict verdict = check_input(self.state.input, measurement, scan);
  self.report(scan, verdict.notes);
  const bool begins_anew = self.look_for_body(measurement, verdict.repeated) && !self.state.beginning.empty();
  const ScanUpdate update = begins_anew ? self.begin_anew() : self.track_scene(measurement, verdict.repeated);
  const bool undecided = std::any_of(self.state.bodies.begin(), self.state.bodies.end(),
                                     [](const auto& body) { return !body.second.decided; });
  if (!undecided) self.state.beginning = {};
  if (self.state.beginning.empty()) self.state.session_start.reset();
  return update;
}

std::optional<Pose2> Slam::predict(Stamp stamp) const {
  const ScanUpdate& last = impl_->state.last;
  if (impl_->state.ledger.keyframes == 0 || last.status == TrackingStatus::kLost) return std::nullopt;
  const double ahead_s = stamp_to_seconds(stamp - last.stamp);
  if (std::abs(ahead_s) > kMostAheadS) return std::nullopt;
  return last.T_map_base() * exp_twist(last.twist, ahead_s);
}

std::shared_ptr<const MapSnapshot> Slam::map() const {
  static const auto kEmpty = std::make_shared<const BackendSnapshot>();
  return make_map_view(impl_->state.entered ? impl_->state.entered->snapshot : kEmpty, impl_->options);
}

void Slam::set_observer(SlamObserver* observer) {
  impl_->observer = observer;
}

std::shared_ptr<SlamState::Data> Slam::Impl::checkpoint() {
  runner->wait();
  auto data = std::make_shared<SlamState::Data>(state);
  data->ledger.records = all_records();
  data->odometry = tracker.state();
  data->suspects = tracker.suspects();
  data->backend = runner->idle().state();
  data->pending = runner->pending();
  return data;
}

SlamState Slam::checkpoint() {
  if (impl_->finished) throw std::logic_error("Slam::checkpoint: the run is finished");
  return SlamState(impl_->checkpoint());
}

/// What comes next is tracked as if nothing had come before.
void Slam::Impl::begin_session() {
  if (next_scan() == session_begin()) return;
  settle_all();
  state.earlier.add(tracker.state());
  tracker = CheckedTracker(options.odometry, {}, {}, options.match);
  state.input.lasers.clear();
  state.input.odometry.reset();
  state.bodies.clear();
  state.beginning.clear();
  state.T_odom_keyframe = {};
  state.keyframe_covariance.setZero();
  state.ledger.sessions.push_back(next_scan());
  state.session_keyframe = state.ledger.keyframes;
  state.session_start.reset();
  state.session_start = checkpoint();
}

/// Nothing comes that those which wait could be judged by.
void Slam::Impl::settle_all() {
  for (const TrackedKeyframe& tracked : tracker.first_keyframe()) take_first(tracked);
  for (const SettledScan& settled : tracker.finish()) settle(settled);
}

void Slam::begin_session() {
  if (impl_->finished) throw std::logic_error("Slam::begin_session: the run is finished");
  impl_->begin_session();
}

SlamResult Slam::finish() {
  Impl& self = *impl_;
  if (std::exchange(self.finished, true)) throw std::logic_error("Slam::finish: the run is finished already");
  const double before = thread_cpu_seconds();
  self.settle_all();
  self.runner->wait();
  self.runner->finish(std::exchange(self.state.batch, {}));
  const Backend& backend = self.runner->idle();
  self.enter(self.runner->final_result(self.state.keyframe_covariance));
  self.state.ledger.records = self.all_records();
  self.packed.clear();
  const ScanLedger& ledger = self.state.ledger;
  std::vector<Pose2> poses = poses_of_scans(ledger, backend.submitted_poses(), backend.submitted_poses(true));
  const bool refined = self.keeps_all() && !ledger.records.empty();
  SlamOptions options = self.options;
  const DeskewTest& deskewing = self.tracker.state().deskew_test;
  if (deskewing.refuted() || self.state.earlier.deskewing_refuted) options.odometry.deskew = false;
  RefinementFit fit;
  if (refined) poses = refine_trajectory(backend, self.state.store, poses, ledger, options.odometry, &fit);
  SlamResult result = make_result(backend, ledger, poses, refined, options);
  make_parts(backend, ledger, poses, refined, static_cast<std::size_t>(self.state.frame_session), options, result);
  self.state.earlier.add(self.tracker.state());
  result.wheels = self.state.earlier.wheels;
  result.oddities = self.state.input.oddities;
  result.deskewed = options.odometry.deskew;
  judge(backend, ledger, fit, refined, self.state.bodies, self.state.input, result);
  self.backend_cpu_s = thread_cpu_seconds() - before;
  return result;
}

std::size_t Slam::scans() const {
  return static_cast<std::size_t>(impl_->next_scan());
}

const SlamOptions& Slam::options() const {
  return impl_->options;
}

double Slam::last_backend_cpu_s() const {
  return impl_->backend_cpu_s;
}

std::size_t SlamState::scans() const {
  return data_->ledger.records.size();
}

}  // namespace phasescan
