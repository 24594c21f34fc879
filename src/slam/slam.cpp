#include "phasescan/slam/slam.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "slam/finished_map.hpp"
#include "slam/map_view.hpp"
#include "slam/result_parts.hpp"
#include "slam/run_judge.hpp"
#include "slam/slam_impl.hpp"
#include "slam/trajectory_refinement.hpp"
#include "slam/whole_run.hpp"

namespace phasescan {
namespace {

constexpr double kMostAheadS = 1.0;  // [s] that predict() looks from the last scan

void check(const RangeMeasurement& measurement) {
  if (!measurement.T_base_laser.is_finite()) throw std::invalid_argument("measurement.T_base_laser: not finite");
  if (measurement.T_odom_base && !measurement.T_odom_base->is_finite())
    throw std::invalid_argument("measurement.T_odom_base: not finite");
}

}  // namespace

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
  auto data = impl_->checkpoint();
  make_whole(*data);
  return SlamState(std::move(data));
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
  if (impl_->finished) throw std::logic_error("Slam::finish: the run is finished already");
  const double before = thread_cpu_seconds();
  if (impl_->state.old.end() > 0) impl_->count_kept();
  Impl& self = *impl_;
  self.finished = true;
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
  if (refined)
    poses = refine_trajectory(backend, self.state.store, poses, ledger, options.odometry, options.match, &fit);
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
