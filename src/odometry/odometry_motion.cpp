// The part of the tracker that knows of motion before and after a scan is matched: what to expect, what the wheels say,
// and how much is known in the end.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "odometry/information.hpp"
#include "phasescan/odometry/odometry.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kProbePoints = 64;  // points of the quick look that chooses among predictions
constexpr double kMinUsualShare = 0.75;   // a prediction that explains less than this of what is usual is widened
constexpr double kHandicap = 0.02;        // of the score, for what does not go on as before or as the wheels say
constexpr int kTurns = 8;                 // looked at to either side where a turn may have begun, so far apart
constexpr double kTurnRad = 0.06;
constexpr double kContradiction =
    11.3;  // squared Mahalanobis distance (99 %) beyond which a step of the wheels is outvoted
// What wheels are off by, standing and in share of what they say, once they are trusted. Cheap robots' wheels.
constexpr double kWheelM = 0.01, kWheelPerM = 0.06, kWheelRad = 0.01, kWheelPerRad = 0.08;
constexpr double kChangeM = 0.025, kChangeRad = 0.06;  // how much the motion per scan changes from one to the next
// What a match against the last scan is off by beside what it claims, and how much more than it claims: what moved
// meanwhile is in no claim.
constexpr double kMatchDoubt = 16.0;  // of the covariance
constexpr double kMatchM = 0.015, kMatchRad = 0.01;

}  // namespace

Pose2 Odometry::predict(const std::optional<Pose2>& wheel_step, double periods, double* best_score) const {
  std::vector<Pose2> steps = {exp_twist(log_pose(step_), periods), Pose2{}};
  if (wheel_step) {
    steps.push_back(*wheel_step);
    steps.push_back({-wheel_step->x, -wheel_step->y, wheel_step->theta});
  }
  const std::size_t stride = std::max<std::size_t>(1, points_->size() / kProbePoints);
  const Pose2 T_map_last = map_.T_world_map().inverse() * T_odom_mid_;
  Pose2 best = steps[0];
  *best_score = -1.0;
  const auto consider = [&](const Pose2& candidate, double handicap) {
    const double score = pose_score(map_, *points_, T_map_last * candidate, stride) - handicap;
    if (score > *best_score) *best_score = score, best = candidate;
  };
  for (std::size_t i = 0; i < steps.size(); ++i) consider(steps[i], i == 0 || i == 2 ? 0.0 : kHandicap);
  if (*best_score < kMinUsualShare * usual_score_) {
    // None explains the scan as scans usually are: perhaps a turn began.
    const Pose2 centre = best;
    for (int k = 1; k <= kTurns; ++k) {
      for (const double side : {-1.0, 1.0}) {
        const double turn = side * k * kTurnRad;
        consider({centre.x, centre.y, wrap_angle(centre.theta + turn)}, kHandicap);
      }
    }
  }
  return best;
}

PosePrior Odometry::make_prior(const Pose2& mean, Eigen::Matrix3d covariance, double periods) const {
  double change_m = kChangeM, change_rad = kChangeRad;
  if (steadiness_.jumps()) {
    change_m = std::max(change_m, steadiness_.change_m());
    change_rad = std::max(change_rad, steadiness_.change_rad());
  }
  covariance.diagonal() += Eigen::Vector3d(change_m * change_m, change_m * change_m, change_rad * change_rad);
  covariance *= periods * periods;
  PosePrior prior;
  prior.T_map_base = map_.T_world_map().inverse() * T_odom_mid_ * mean;
  // The points of a scan are not independent of each other: the prior is weighed against a share of what they claim.
  prior.information = rotate_information(covariance.inverse() / kMatchTrust, prior.T_map_base.theta);
  return prior;
}

PosePrior Odometry::hear_last_scan(const PosePrior& prior, const LastScanWitness& last) const {
  Eigen::Matrix3d covariance = kMatchDoubt * last.covariance;
  covariance.diagonal() += Eigen::Vector3d(kMatchM * kMatchM, kMatchM * kMatchM, kMatchRad * kMatchRad);
  const Eigen::Matrix3d told = covariance.inverse() / kMatchTrust;
  const Pose2 &a = prior.T_map_base, &b = last.T_map_mid;
  PosePrior both;
  both.information = prior.information + told;
  const Eigen::Vector3d off(b.x - a.x, b.y - a.y, wrap_angle(b.theta - a.theta));
  const Eigen::Vector3d shift = both.information.inverse() * (told * off);
  if (!shift.allFinite()) return prior;
  both.T_map_base = {a.x + shift.x(), a.y + shift.y(), wrap_angle(a.theta + shift.z())};
  return both;
}

Pose2 Odometry::hear_wheels(const Pose2& moved, const Pose2& wheel_step, Eigen::Matrix3d& known) const {
  if (!hears_wheels()) return moved;
  const double sigma_m = (kWheelM + kWheelPerM * std::hypot(wheel_step.x, wheel_step.y)) / wheels_.trust_distance();
  const double sigma_rad = (kWheelRad + kWheelPerRad * std::abs(wheel_step.theta)) / wheels_.trust_turn();
  const Eigen::Vector3d variance(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad);
  // In the frame of the new base, as `known` is.
  const Pose2 off = moved.inverse() * wheel_step;
  const Eigen::Vector3d d(off.x, off.y, off.theta);
  const Eigen::Matrix3d spread = known.inverse() + Eigen::Matrix3d(variance.asDiagonal());
  const double contradiction = d.dot(spread.inverse() * d);
  if (contradiction > kContradiction) return moved;
  // The more they differ from what was seen, the less they are heard: wheels lie by kind, not by chance.
  const double heard = 1.0 / ((1.0 + contradiction) * (1.0 + contradiction));
  const Eigen::Matrix3d wheels = (heard * variance.cwiseInverse()).asDiagonal();
  const Eigen::Matrix3d sum = known + wheels;
  const Eigen::Vector3d shift = sum.inverse() * (wheels * d);
  known = sum;
  return moved * Pose2{shift.x(), shift.y(), shift.z()};
}

Eigen::Matrix3d Odometry::grow_information(const Eigen::Matrix3d& matched, const Eigen::Matrix3d& known,
                                           const Pose2& moved) {
  // Where the match sees, it sees relative to the map; where it does not, every step adds its own doubt.
  const Eigen::Matrix3d only_step = known - matched;
  Eigen::Matrix3d doubt = rotate_information(since_keyframe_, -moved.theta);
  doubt += (only_step + Eigen::Matrix3d(Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal())).inverse();
  since_keyframe_ = (matched + doubt.inverse()).inverse();
  since_keyframe_ = 0.5 * (since_keyframe_ + since_keyframe_.transpose().eval());
  return since_keyframe_.inverse();
}

}  // namespace phasescan
