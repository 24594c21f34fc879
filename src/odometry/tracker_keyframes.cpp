// The tracker's keyframes: when a scan becomes one, the first one's second look, and the map made of them.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"
#include "odometry/tracker.hpp"

namespace phasescan {
namespace {

// Keyframes: standard deviation since the last one that asks for another [m]; overlap below which the map does not hold
// enough of the scan, and share of the usual way that must have been driven then.
constexpr double kUncertainM = 0.15, kLowOverlap = 0.6, kLeastShare = 0.3;
constexpr double kMapMarginM = 5.0;  // [m] the map reaches so much farther than a scan
// What a robot may change its motion by during the first turn, unseen: half a turn of accelerations [m/s^2], [rad/s^2].
constexpr double kStartAcceleration = 0.5 * 0.5, kStartTurnAcceleration = 0.5 * 0.8;

}  // namespace

void Tracker::deskew_first(const Twist2& twist, const SearchPolicy& policy) {
  const FirstKeyframe& first = *state_.first;
  const Frame frame = frame_of(*first.distorted, twist, first.duration_s, policy);
  // The first scan stands with its stamp at the origin, as all others stand with theirs.
  state_.T_odom_mid = exp_twist(twist, middle_of_turn_s(first.distorted->scan, first.duration_s));
  state_.window.front() = {frame.all_points, state_.T_odom_mid};
  // The stamp is the origin, and the middle of the turn as uncertain as the motion up to it.
  const double square = first.duration_s * first.duration_s, sigma_m = kStartAcceleration * square,
               sigma_rad = kStartTurnAcceleration * square;
  state_.keyframe_covariance.diagonal() += Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad);
  TrackedKeyframe& keyframe = state_.first->keyframe;
  keyframe.points = frame.points;
  keyframe.T_odom_base = state_.T_odom_mid;
  keyframe.T_mid_stamp = state_.T_odom_mid.inverse();
  rebuild_map();
}

void Tracker::remember(const Scanned& scanned, TrackerStep& step) {
  const bool enough = scanned.frame.has_enough_points();
  const bool lost = !step.tracked() && enough && state_.untracked >= scanned.policy.lost_after_scans;
  if (lost) {
    // Nothing but the prediction ties what comes to what was.
    step.diagnostics.new_segment = true;
    state_.last_scans.forget();
    state_.untracked = 0;
  }
  if (step.tracked() || lost) {
    state_.last_scans.remember(without_moving_objects(scanned.measurement, scanned.frame), step.T_odom_stamp,
                               deskews() ? step.twist : Twist2{});
  }
  if (lost || (step.tracked() && enough && wants_keyframe(scanned, step))) insert_keyframe(scanned, step);
}

bool Tracker::wants_keyframe(const Scanned& scanned, const TrackerStep& step) const {
  const Pose2 since = state_.window.back().T_odom_base.inverse() * state_.T_odom_mid;
  const double share = std::hypot(since.x, since.y) / options_.keyframe_distance_m +
                       std::abs(since.theta) / deg_to_rad(options_.keyframe_angle_deg);
  // What was driven unseen is corrected between keyframes: they must stand close there, however far it seemed.
  const bool uncertain = largest_deviation(step.information) > kUncertainM;
  const bool little_known = step.diagnostics.overlap < kLowOverlap && share > kLeastShare;
  return share > 1.0 || little_known || uncertain || scanned.new_laser;
}

void Tracker::insert_keyframe(const Scanned& scanned, TrackerStep& step) {
  step.keyframe = true;
  TrackedKeyframe keyframe;
  keyframe.scan = state_.scans;
  keyframe.stamp = step.stamp;
  keyframe.T_odom_base = step.T_odom_mid;
  keyframe.T_mid_stamp = step.T_odom_mid.inverse() * step.T_odom_stamp;
  keyframe.points = scanned.frame.points;
  keyframe.information = step.information;
  keyframe.new_segment = step.diagnostics.new_segment;
  keyframe.laser = scanned.measurement.laser;
  keyframe.T_base_laser = scanned.measurement.T_base_laser;
  keyframe.twist = step.twist;
  step.keyframes.push_back(std::move(keyframe));
  if (!state_.window.empty()) {
    state_.keyframe_covariance = chain_covariance(state_.window.back().T_odom_base, state_.keyframe_covariance,
                                                  state_.T_odom_mid, state_.since_keyframe.drift);
  }
  state_.since_keyframe = {};
  if (step.diagnostics.new_segment) state_.window.clear();
  state_.window.push_back({scanned.frame.all_points, state_.T_odom_mid});
  while (state_.window.size() > static_cast<std::size_t>(options_.window_keyframes))
    state_.window.erase(state_.window.begin());
  rebuild_map();
}

void Tracker::emit_first(bool deskewed, TrackerStep& step) {
  TrackedKeyframe first = std::move(state_.first->keyframe);
  if (deskewed) first.twist = step.twist;  // near enough to what its scan was deskewed with
  step.keyframes.insert(step.keyframes.begin(), std::move(first));
  state_.first.reset();
}

void Tracker::rebuild_map() {
  map_.reset(state_.window.back().T_odom_base, options_.map_range_m + kMapMarginM, options_.cell_m);
  for (const WindowKeyframe& keyframe : state_.window) map_.add(*keyframe.points, keyframe.T_odom_base);
  map_.finish();
}

}  // namespace phasescan
