#include "odometry/tracker.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/motion.hpp"
#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

// A pose that stays within these of where the robot came to rest is rest [m], [rad].
constexpr double kStillM = 0.006, kStillRad = 0.003;
// [m] by which the motion found may distort a scan, two metres from the sensor, beside what was expected, for it to
// stay.
constexpr double kDistortionM = 0.01;
constexpr double kDeskewedGateM = 0.15;  // [m] of the registration after that: the pose is known
// Share of the usual score: a match after a gap that explains less is chance.
constexpr double kAfterGapShare = 0.8;
// [rad] in one scan's turn: three centimetres at the far end of a room.
constexpr double kTestTurnRad = 0.035;
constexpr double kLittleExplained = 0.6;  // overlap below which a match counts as degraded
constexpr double kMemoryOfScore = 0.95;   // weight of the past in the usual score
// Standard deviations of the first pose, which is the origin: no more than keeps the covariance definite [m], [rad].
constexpr double kStartM = 1e-4, kStartRad = 1e-4;

/// At rest the mean of all poses is better than the last one, and it does not wander.
Pose2 zero_velocity_update(const Pose2& T_odom_mid, Standstill& still) {
  if (still.count > 0) {
    const Pose2 off = still.first.inverse() * T_odom_mid;
    if (std::hypot(off.x, off.y) < kStillM && std::abs(off.theta) < kStillRad) {
      ++still.count;
      still.sum.x += off.x;
      still.sum.y += off.y;
      still.sum.theta += off.theta;
      const double n = still.count;
      return still.first * Pose2{still.sum.x / n, still.sum.y / n, still.sum.theta / n};
    }
  }
  still = {T_odom_mid, {}, 1};
  return T_odom_mid;
}

TrackingStatus status_of(const TrackingDiagnostics& found, bool determined, double min_overlap) {
  if (found.overlap < min_overlap) return TrackingStatus::kDegraded;
  if (!determined) return TrackingStatus::kAmbiguous;
  const bool hard = found.wide_search || found.full_search || found.overlap < kLittleExplained;
  return hard ? TrackingStatus::kDegraded : TrackingStatus::kOk;
}

}  // namespace

Tracker::Tracker(const OdometryOptions& options, OdometryState state, const MatchOptions& match)
    : options_(options), state_(std::move(state)), scan_to_scan_(match) {
  validate_options("odometry", options_);
  if (!state_.window.empty()) rebuild_map();
}

TrackerStep Tracker::add(const RangeMeasurement& measurement) {
  Scanned scanned = begin(measurement);
  TrackerStep step;
  step.stamp = measurement.scan.stamp;
  if (state_.window.empty()) {
    start(scanned, step);
  } else {
    expect(scanned);
    const double usual_score = state_.usual_score;
    const Pose2 step_before = state_.motion.step;
    const Solution solution = solve(scanned);
    const PoseSolution& pose = solution.pose;
    step.diagnostics.overlap = pose.found.overlap;
    step.diagnostics.residual_m = pose.found.residual_m;
    step.diagnostics.wide_search = pose.wide_search;
    step.diagnostics.full_search = pose.full_search;
    scanned.motion = state_.motion.with_scans_missing(scanned.motion, T_map_last().inverse() * pose.found.T_map_base);
    const Pose2 moved = is_matched(scanned, pose) ? correct(scanned, pose, step) : coast(scanned, step);
    judge_fit(scanned, pose.score / usual_score, step_before, moved, step);
    move(scanned, moved, step);
    remember(scanned, step);
    if (state_.first) emit_first(solution.first_deskewed, step);
  }
  ++state_.scans;
  return step;
}

void Tracker::restore(OdometryState state) {
  const auto same = [](const WindowKeyframe& a, const WindowKeyframe& b) {
    return a.points == b.points && a.T_odom_base == b.T_odom_base;
  };
  const bool same_map =
      std::equal(state.window.begin(), state.window.end(), state_.window.begin(), state_.window.end(), same);
  state_ = std::move(state);
  if (!same_map && !state_.window.empty()) rebuild_map();
}

std::vector<TrackedKeyframe> Tracker::finish() {
  std::vector<TrackedKeyframe> last;
  if (state_.first) last.push_back(std::move(state_.first->keyframe));
  state_.first.reset();
  return last;
}

Tracker::Scanned Tracker::begin(const RangeMeasurement& measurement) {
  Scanned scanned{measurement, {}, {}, {}, false, {}};
  ScanTiming timing = state_.clock.add(measurement.scan);
  if (!options_.deskew || state_.deskew_test.refuted())
    timing.duration_s = 0.0;  // all beams of one time: that of the stamp
  scanned.motion = state_.motion.begin_scan(timing, measurement.T_odom_base, options_);
  scanned.policy = search_policy(state_.motion.variability, options_, timing);
  scanned.frame = frame_of(measurement, scanned.motion.twist, timing.duration_s, scanned.policy);
  return scanned;
}

Frame Tracker::frame_of(const RangeMeasurement& measurement, const Twist2& twist, double duration_s,
                        const SearchPolicy& policy) {
  Frame frame = prepare_frame(measurement, twist, duration_s, policy, options_, work_);
  select_static_points(map_, T_map_last() * state_.motion.step, work_, frame);
  return frame;
}

void Tracker::start(const Scanned& scanned, TrackerStep& step) {
  state_.keyframe_covariance =
      Eigen::Vector3d(kStartM * kStartM, kStartM * kStartM, kStartRad * kStartRad).asDiagonal();
  step.covariance = state_.keyframe_covariance;
  if (!scanned.frame.has_enough_points()) return;
  step.status = TrackingStatus::kOk;
  step.diagnostics.overlap = 1.0;
  insert_keyframe(scanned, step);
  state_.last_scans.remember(without_moving_objects(scanned.measurement, scanned.frame), state_.T_odom_mid, {});
  FirstKeyframe first;
  first.keyframe = std::move(step.keyframes.back());
  step.keyframes.clear();
  first.duration_s = scanned.motion.timing.duration_s;
  if (options_.deskew && first.duration_s > 0.0) first.distorted = scanned.measurement;
  state_.first = std::move(first);
}

void Tracker::expect(Scanned& scanned) {
  MotionModel& motion = state_.motion;
  if (scanned.motion.timing.gap) motion.forget_speed();
  // A laser heard for the first time may look where no other did. Its half of a room fits another's after half a turn:
  // the way so far says where it is.
  scanned.new_laser = scanned.policy.place_new_laser_by_motion && !state_.last_scans.knows(scanned.measurement.laser) &&
                      state_.untracked == 0 && !scanned.motion.timing.gap && scanned.frame.has_enough_points();
  motion.learned.observe(work_.surface);
  scanned.expected = motion.predict(map_, *scanned.frame.points, T_map_last(), scanned.motion, scanned.policy,
                                    scanned.new_laser, options_);
}

Tracker::Solution Tracker::solve(Scanned& scanned) {
  Solution solution;
  const MotionPrediction& expected = scanned.expected;
  PoseSolution& pose = solution.pose;
  pose.prior = expected.prior;
  pose.found.T_map_base = T_map_last() * expected.step;
  if (scanned.new_laser) {
    pose.found = register_points(map_, *scanned.frame.points, pose.prior.T_map_base, {}, pose.prior);
    if (pose.found.overlap < options_.min_overlap) {
      pose.found = {};
      pose.found.T_map_base = pose.prior.T_map_base;
    }
  } else if (scanned.frame.has_enough_points()) {
    PoseQuery query;
    query.guess = pose.found.T_map_base;
    query.prior = expected.prior;
    query.learned = expected.learned;
    query.match_last_scan = [&] { return match_last_scan(scanned); };
    query.min_overlap = options_.min_overlap;
    query.usual_score = state_.usual_score;
    pose = solve_pose(map_, *scanned.frame.points, query, scanned.policy);
    if (pose.found.overlap >= options_.min_overlap)
      state_.usual_score = kMemoryOfScore * state_.usual_score + (1.0 - kMemoryOfScore) * pose.score;
    const MotionInput& motion = scanned.motion;
    if (options_.deskew && motion.timing.duration_s > 0.0 && motion.seconds > 0.0) solve_deskewed(scanned, solution);
  }
  return solution;
}

std::optional<LastScanMatch> Tracker::match_last_scan(const Scanned& scanned) {
  const RangeMeasurement& measurement = scanned.measurement;
  // Where the scan's points are expressed, seen from its stamp.
  const Twist2 used = deskews() ? scanned.motion.twist : Twist2{};
  const std::optional<ScanToScan::Found> found =
      scan_to_scan_.find(state_.last_scans, without_moving_objects(measurement, scanned.frame), used);
  if (!found) return std::nullopt;
  const Pose2 T_stamp_mid = exp_twist(used, middle_of_turn_s(measurement.scan, scanned.motion.timing.duration_s));
  const Pose2& T_odom_map = map_.T_world_map();
  return LastScanMatch{T_odom_map.inverse() * (found->T_odom_base * T_stamp_mid),
                       rotate_information(found->covariance, -T_odom_map.theta), found->usable, found->certain};
}

void Tracker::solve_deskewed(Scanned& scanned, Solution& solution) {
  Registration& found = solution.pose.found;
  const double duration_s = scanned.motion.timing.duration_s, seconds = scanned.motion.seconds;
  const auto twist_found = [&] { return mean_twist(T_map_last().inverse() * found.T_map_base, seconds); };
  // The motion found says how the scan was distorted: once more, deskewed.
  const Twist2 now = twist_found(), &used = scanned.motion.twist;
  const double change = std::hypot(now.vx - used.vx, now.vy - used.vy) + 2.0 * std::abs(now.omega - used.omega);
  if (change * duration_s > kDistortionM) {
    scanned.frame = frame_of(scanned.measurement, now, duration_s, scanned.policy);
    RegistrationOptions again;
    again.gate_start_m = kDeskewedGateM;
    found = register_points(map_, *scanned.frame.points, found.T_map_base, again, solution.pose.prior);
  }
  test_deskewing(scanned, now.omega * duration_s, solution);
  if (state_.first && state_.first->distorted && found.overlap >= options_.min_overlap) {
    deskew_first(twist_found(), scanned.policy);
    solution.first_deskewed = true;
    found = register_points(map_, *scanned.frame.points, found.T_map_base, {}, solution.pose.prior);
  }
}

/// On turns a scan without its distortion lies closer on the map than with it, unless its beams were of one time.
void Tracker::test_deskewing(const Scanned& scanned, double turn_rad, const Solution& solution) {
  DeskewTest& test = state_.deskew_test;
  const Registration& found = solution.pose.found;
  if (test.decided() || std::abs(turn_rad) < kTestTurnRad || state_.first || found.overlap < options_.min_overlap)
    return;
  const Frame as_it_came = frame_of(scanned.measurement, {}, scanned.motion.timing.duration_s, scanned.policy);
  const Registration other = register_points(map_, *as_it_came.points, found.T_map_base, {}, solution.pose.prior);
  ++test.turns;
  test.better += found.residual_m < other.residual_m;
}

bool Tracker::is_matched(const Scanned& scanned, const PoseSolution& pose) {
  const Registration& found = pose.found;
  if (scanned.motion.timing.gap &&
      pose_score(map_, *scanned.frame.points, found.T_map_base) < kAfterGapShare * state_.usual_score) {
    // The robot may have been carried anywhere meanwhile; rooms look alike enough for a match to be found in any.
    state_.untracked = options_.lost_after_scans;
    return false;
  }
  if (scanned.policy.must_explain && !pose.full_search &&
      pose.score < scanned.policy.alone_share * state_.usual_score) {
    // What comes next would be matched near a pose that is a guess.
    state_.untracked = options_.lost_after_scans;
    return false;
  }
  return scanned.new_laser || found.overlap >= options_.min_overlap;
}

void Tracker::judge_fit(const Scanned& scanned, double score_share, const Pose2& step_before, const Pose2& moved,
                        TrackerStep& step) const {
  const MotionInput& motion = scanned.motion;
  if (state_.first || scanned.new_laser || scanned.policy.always_try_last_scan || motion.timing.gap ||
      !scanned.frame.has_enough_points())
    return;
  step.fit.judged = true;
  step.fit.score_share = step.tracked() ? score_share : 0.0;
  const auto consider = [&](const Pose2& expected, bool nearest) {
    const Pose2 off = expected.inverse() * moved;
    const double m = std::hypot(off.x, off.y), rad = std::abs(off.theta);
    if (!nearest || m + rad < step.fit.off_m + step.fit.off_rad) step.fit.off_m = m, step.fit.off_rad = rad;
  };
  consider(scale_motion(step_before, motion.timing.periods), false);
  if (motion.wheel_step) consider(*motion.wheel_step, true);
}

Pose2 Tracker::correct(const Scanned& scanned, const PoseSolution& pose, TrackerStep& step) {
  const MotionUpdate update =
      state_.motion.fuse(pose.found, pose.prior, T_map_last().inverse() * pose.found.T_map_base, scanned.motion);
  state_.motion.correct(update, scanned.expected.score, scanned.motion);
  state_.since_keyframe.grow(update, state_.window.size());
  state_.untracked = 0;
  step.diagnostics.wheels = update.wheels;
  step.status = status_of(step.diagnostics, determines_position(update.seen), options_.min_overlap);
  return update.moved;
}

Pose2 Tracker::coast(const Scanned& scanned, TrackerStep& step) {
  ++state_.untracked;
  state_.since_keyframe.grow_unseen();
  step.status = TrackingStatus::kLost;
  return state_.motion.step_without_match(scanned.expected.step, scanned.motion);
}

void Tracker::move(const Scanned& scanned, const Pose2& moved, TrackerStep& step) {
  const Pose2 T_odom_before = state_.T_odom_mid;
  Pose2& T_odom_mid = state_.T_odom_mid;
  const MotionInput& motion = scanned.motion;
  T_odom_mid = T_odom_before * moved;
  state_.motion.set_twist(moved, motion);
  if (options_.standstill_lock && step.tracked()) {
    T_odom_mid = zero_velocity_update(T_odom_mid, state_.standstill);
  } else {
    state_.standstill.count = 0;
  }
  step.T_odom_mid = T_odom_mid;
  step.twist = state_.motion.twist;
  const Eigen::Matrix3d& since = state_.since_keyframe.covariance;
  step.information = since.inverse();
  step.covariance = chain_covariance(state_.window.back().T_odom_base, state_.keyframe_covariance, T_odom_mid, since);
  // The stamp lies half a turn before the middle, between the last middle and this one where turns follow each other
  // closely; behind it where beams are listed last to first.
  const double duration_s = motion.timing.duration_s;
  step.T_odom_stamp = T_odom_mid;
  if (duration_s > 0.0 && motion.seconds > 0.0) {
    const double back = std::clamp(middle_of_turn_s(scanned.measurement.scan, duration_s) / motion.seconds, -1.0, 1.0);
    step.T_odom_stamp = T_odom_before * scale_motion(T_odom_before.inverse() * T_odom_mid, 1.0 - back);
  }
}

}  // namespace phasescan
