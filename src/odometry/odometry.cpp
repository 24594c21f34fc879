#include "phasescan/odometry/odometry.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/motion.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kStillM = 0.006, kStillRad = 0.003;
constexpr std::size_t kMinPoints = 12;
constexpr double kBentM = 0.01;  // what the motion may bend a scan, two metres from the sensor, for it to stay as it is
constexpr int kLostAfterJumps = 2;
constexpr double kAfterGapShare = 0.8;  // a match after a gap that explains less than this of what is usual is chance
constexpr double kDoubtfulM = 0.15;     // standard deviation since the last keyframe that asks for another
// However long nothing shows the motion along a wall, so much is known of a step: else the first chance hit decides it.
constexpr double kMostStepM = 0.15;
constexpr double kWheelShare = 0.5;  // of trusted wheels in what is expected
const Eigen::Vector3d kUnknownStep(0.05 * 0.05, 0.05 * 0.05, 0.1 * 0.1);

/// The middle of a scan's turn after its stamp [s].
double middle_s(const Scan& scan, double duration_s) {
  return scan.time_increment < 0.0 ? -0.5 * duration_s : 0.5 * duration_s;
}

}  // namespace

Odometry::Odometry(const OdometryOptions& options) : options_(options) {
  validate_options("odometry", options_);
}

void Odometry::extract(const Scan& scan, const Pose2& T_base_laser, const Twist2& twist, double duration_s) {
  const Twist2 used = options_.deskew && duration_s > 0.0 ? twist : Twist2{};
  // Scans that stand far apart meet as two scans do, and not as a scan meets the map of those just before it.
  find_surface(scan, twist_of_frame(T_base_laser, used), surface_work_, surface_,
               steadiness_.jumps() ? WallLines{} : kTrackingLines);
  // The points are expressed at the stamp; the middle of the turn is where the twist's error matters least.
  const Pose2 T_mid_laser = exp_twist(used, middle_s(scan, duration_s)).inverse() * T_base_laser;
  all_points_ = std::make_shared<MapPoints>();
  to_map_points(surface_, T_mid_laser, options_.map_range_m, *all_points_, &beams_);
  // Where scans stand far apart nothing is seen often enough to show that it stays.
  if (steadiness_.jumps()) std::fill(all_points_->small.begin(), all_points_->small.end(), std::uint8_t{0});
  choose_points();
}

OdometryStep Odometry::add(const RangeMeasurement& measurement) {
  const Scan& scan = measurement.scan;
  OdometryStep step;
  const ScanTiming timing = clock_.add(scan);
  steadiness_.set_period(timing.period_s);
  std::optional<Pose2> wheel_step = options_.use_wheels ? wheels_.step(measurement.T_odom_base) : std::nullopt;
  const double seconds = timing.period_s * timing.periods;  // 0: not known
  Twist2 twist = twist_;
  if (wheel_step && wheels_.trust_turn() >= kLeastTrust && seconds > 0.0) twist.omega = wheel_step->theta / seconds;
  extract(scan, measurement.T_base_laser, twist, timing.duration_s);

  if (!started_) {
    started_ = points_->with_normal >= kMinPoints;
    if (started_) {
      step.tracked = true;
      step.overlap = 1.0;
      insert_keyframe(step);
      last_scan_.remember(without_people(measurement), T_odom_mid_, {});
      if (options_.deskew && timing.duration_s > 0.0)
        first_ = First{measurement, timing.duration_s, all_points_, points_};
    }
    return step;
  }

  double score = 0.0;
  if (timing.gap) {
    step_ = Pose2{};
    step_covariance_ = 100.0 * kUnknownStep.asDiagonal();
  }
  const Pose2 predicted = predict(wheel_step, timing.periods, &score);
  // A laser heard for the first time may look where no other did. Its half of a room fits another's after half a turn:
  // the way so far says where it is.
  const bool new_laser = !last_scan_.knows(measurement.laser) && untracked_ == 0 && !timing.gap &&
                         !steadiness_.jumps() && points_->with_normal >= kMinPoints;
  // Robots keep on doing what they did.
  Pose2 mean = exp_twist(log_pose(options_.motion_habits ? habits_.expect(step_) : step_), timing.periods);
  if (!new_laser) mean.theta = predicted.theta;
  if (wheel_step && hears_wheels()) {
    // Wheels know of a change of speed before the habit of going on does.
    mean.x += kWheelShare * (wheel_step->x - mean.x);
    mean.y += kWheelShare * (wheel_step->y - mean.y);
    if (new_laser) mean = *wheel_step;
  }
  PosePrior prior = make_prior(mean, step_covariance_, timing.periods);
  habits_.add(surface_);
  ask_habits_ = options_.motion_habits && !(wheel_step && wheels_.trust_distance() >= kLeastTrust);
  Pose2 T_map_odom = map_.T_world_map().inverse();
  Registration found;
  found.T_map_base = T_map_odom * T_odom_mid_ * predicted;
  if (new_laser) {
    found = register_points(map_, *points_, prior.T_map_base, {}, prior);
    if (found.overlap < options_.min_overlap) {
      found = {};
      found.T_map_base = prior.T_map_base;
    }
  } else if (points_->with_normal >= kMinPoints) {
    // Where the scan's points are expressed, seen from its stamp.
    const Pose2 T_stamp_mid = exp_twist(options_.deskew ? twist : Twist2{}, middle_s(scan, timing.duration_s));
    found = match(ask_last_scan(measurement, twist, T_stamp_mid), found.T_map_base, timing.periods, prior, step);
    if (options_.deskew && timing.duration_s > 0.0 && seconds > 0.0) {
      // The motion found says how the scan was bent: once more, unbent.
      const Twist2 better = log_pose((T_map_odom * T_odom_mid_).inverse() * found.T_map_base);
      const Twist2 now{better.vx / seconds, better.vy / seconds, better.omega / seconds};
      const double change = std::hypot(now.vx - twist.vx, now.vy - twist.vy) + 2.0 * std::abs(now.omega - twist.omega);
      if (change * timing.duration_s > kBentM) {
        extract(scan, measurement.T_base_laser, now, timing.duration_s);
        RegistrationOptions again;
        again.gate_start_m = 0.15;
        found = register_points(map_, *points_, found.T_map_base, again, prior);
      }
      if (first_ && found.overlap >= options_.min_overlap) {
        const Twist2 t = log_pose((T_map_odom * T_odom_mid_).inverse() * found.T_map_base);
        unbend_first({t.vx / seconds, t.vy / seconds, t.omega / seconds}, step);
        T_map_odom = map_.T_world_map().inverse();
        found = register_points(map_, *points_, found.T_map_base, {}, prior);
      }
    }
  }
  first_.reset();
  step.overlap = found.overlap;
  step.residual_m = found.residual_m;
  step.tracked = new_laser || found.overlap >= options_.min_overlap;
  if (timing.gap && pose_score(map_, *points_, found.T_map_base) < kAfterGapShare * usual_final_) {
    // The robot may have been carried anywhere meanwhile; rooms look alike enough for a match to be found in any.
    step.tracked = false;
    untracked_ = options_.lost_after_scans;
  }
  Pose2 moved = predicted;
  if (step.tracked) {
    moved = (T_map_odom * T_odom_mid_).inverse() * found.T_map_base;
    const Eigen::Matrix3d seen = kMatchTrust * rotate_information(found.information, -found.T_map_base.theta);
    Eigen::Matrix3d known = seen + kMatchTrust * rotate_information(prior.information, -found.T_map_base.theta);
    if (wheel_step) {
      step.wheels = wheels_.judge(*wheel_step, moved, doubt_of(seen, moved.theta));
      moved = hear_wheels(moved, *wheel_step, known);
    }
    step_covariance_ = known.inverse() / (timing.periods * timing.periods);
    bound_translation(step_covariance_, kMostStepM);
    step.information = grow_information(seen, known, moved);
    untracked_ = 0;
    steadiness_.add(exp_twist(log_pose(step_), timing.periods).inverse() * moved);
    usual_score_ = kSlow * usual_score_ + (1.0 - kSlow) * std::max(score, 0.0);
    step_ = exp_twist(log_pose(moved), 1.0 / timing.periods);
    habits_.learn(step_, sees_both_ways(seen));
  } else {
    ++untracked_;
    if (wheel_step && wheels_.trust_distance() >= kLeastTrust) moved = *wheel_step;
    step_ = exp_twist(log_pose(step_), 0.5);
    step_covariance_ = kUnknownStep.asDiagonal();
    since_keyframe_ += kUnknownStep.asDiagonal();
    step.information = since_keyframe_.inverse();
  }
  const Pose2 T_odom_before = T_odom_mid_;
  T_odom_mid_ = T_odom_mid_ * moved;
  if (seconds > 0.0) {
    const Twist2 t = log_pose(moved);
    twist_ = {t.vx / seconds, t.vy / seconds, t.omega / seconds};
  }
  step.T_odom_mid = T_odom_mid_;
  hold_still(step);
  T_odom_mid_ = step.T_odom_mid;
  step.twist = twist_;
  // The stamp lies half a turn before the middle, between the last middle and this one where turns follow each other
  // closely; behind it where beams are listed last to first.
  if (timing.duration_s > 0.0 && seconds > 0.0) {
    const double back = std::clamp(middle_s(scan, timing.duration_s) / seconds, -1.0, 1.0);
    step.T_odom_stamp = T_odom_before * exp_twist(log_pose(T_odom_before.inverse() * T_odom_mid_), 1.0 - back);
  } else {
    step.T_odom_stamp = T_odom_mid_;
  }

  if (step.tracked) last_scan_.remember(without_people(measurement), step.T_odom_stamp, twist_);

  const bool enough = points_->with_normal >= kMinPoints;
  // Where scans jump, the next ones share less and less with the map that lost this one.
  const int lost_after =
      steadiness_.jumps() ? std::min(kLostAfterJumps, options_.lost_after_scans) : options_.lost_after_scans;
  if (!step.tracked && enough && untracked_ >= lost_after) {
    step.new_segment = true;
    window_.clear();
    insert_keyframe(step);
    last_scan_.forget();
    last_scan_.remember(without_people(measurement), step.T_odom_stamp, twist_);
    untracked_ = 0;
  } else if (step.tracked && enough) {
    const Pose2 since = window_.back().T_odom_base.inverse() * T_odom_mid_;
    const double share = std::hypot(since.x, since.y) / options_.keyframe_distance_m +
                         std::abs(since.theta) / deg_to_rad(options_.keyframe_angle_deg);
    // What was driven unseen is corrected between keyframes: they must stand close there, however far it seemed.
    const bool doubtful = largest_deviation(step.information) > kDoubtfulM;
    if (share > 1.0 || (step.overlap < 0.6 && share > 0.3) || doubtful || new_laser) insert_keyframe(step);
  }
  return step;
}

void Odometry::hold_still(OdometryStep& step) {
  if (!options_.standstill_lock || !step.tracked) {
    still_count_ = 0;
    return;
  }
  if (still_count_ > 0) {
    const Pose2 off = still_first_.inverse() * step.T_odom_mid;
    if (std::hypot(off.x, off.y) < kStillM && std::abs(off.theta) < kStillRad) {
      // At rest the mean of all answers is better than the last one, and it does not wander.
      ++still_count_;
      still_sum_.x += off.x;
      still_sum_.y += off.y;
      still_sum_.theta += off.theta;
      const double n = still_count_;
      step.T_odom_mid = still_first_ * Pose2{still_sum_.x / n, still_sum_.y / n, still_sum_.theta / n};
      return;
    }
  }
  still_first_ = step.T_odom_mid;
  still_sum_ = {};
  still_count_ = 1;
}

void Odometry::insert_keyframe(OdometryStep& step) {
  step.is_keyframe = true;
  since_keyframe_.setZero();
  window_.push_back({all_points_, T_odom_mid_});
  while (window_.size() > static_cast<std::size_t>(options_.window_keyframes)) window_.pop_front();
  rebuild_map();
}

void Odometry::unbend_first(const Twist2& twist, OdometryStep& step) {
  // The first scan stands with its stamp at the origin, as all others stand with theirs.
  const std::shared_ptr<MapPoints> last = all_points_, last_chosen = points_;
  const std::vector<int> last_left_out = left_out_;
  extract(first_->measurement.scan, first_->measurement.T_base_laser, twist, first_->duration_s);
  *first_->all_points = *all_points_;
  *first_->points = *points_;
  all_points_ = last;
  points_ = last_chosen;
  left_out_ = last_left_out;
  T_odom_mid_ = exp_twist(twist, middle_s(first_->measurement.scan, first_->duration_s));
  window_.front().T_odom_base = T_odom_mid_;
  step.T_odom_first = T_odom_mid_;
  rebuild_map();
}

void Odometry::rebuild_map() {
  map_.reset(T_odom_mid_, options_.map_range_m + 5.0, options_.cell_m);
  for (const WindowFrame& frame : window_) map_.add(*frame.points, frame.T_odom_base);
  map_.finish();
}

}  // namespace phasescan
