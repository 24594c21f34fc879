#include "odometry/motion_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/motion.hpp"
#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

// Constants below without another origin were chosen by hand on the recorded logs.
// The quick look that chooses among predictions: points; what is taken off the score of one that neither goes on as
// before nor as the wheels say; a best score below this share of the usual one looks at turns as well, so many to
// either side, so far apart [rad].
constexpr std::size_t kProbePoints = 64;
constexpr double kHandicap = 0.02;
constexpr double kMinUsualShare = 0.75;
constexpr int kTurns = 8;
constexpr double kTurnRad = 0.06;
constexpr double kMemoryOfUsual = 0.95;  // weight of the past in the usual score
// How much the motion per scan changes from one to the next in dense logs [m], [rad].
constexpr double kChangeM = 0.025, kChangeRad = 0.06;
// Wheels that agreed less often lately are not heard; trusted ones count by this share in what is expected.
constexpr double kLeastTrust = 0.6, kWheelShare = 0.5;
// What wheels are off by once they are trusted: standing [m], [rad], and in share of what they say. Cheap robots'
// wheels.
constexpr double kWheelM = 0.01, kWheelPerM = 0.06, kWheelRad = 0.01, kWheelPerRad = 0.08;
constexpr double kContradiction = 11.3;  // squared Mahalanobis distance (99 %, 3 dof) beyond which wheels are not fused
// However long nothing shows the motion along a wall, so much is known of a step [m]: else the first chance hit
// decides.
constexpr double kMostStepM = 0.15;
// Standard deviations of a step of which nothing is known [m], [rad], and how much wider after a gap, of the variance.
constexpr double kUnknownM = 0.05, kUnknownRad = 0.1, kAfterGap = 100.0;
// Periods by which a step is longer than the ones before for scans to be missing; [m] of a step.
constexpr double kLeastMissing = 3.0, kLeastStepM = 0.02;
constexpr double kSlowDown = 0.5;  // of the speed, per scan without a match

/// Covariance of a step of which nothing is known, a usual period long.
Eigen::Matrix3d unknown_step_covariance() {
  return Eigen::Vector3d(kUnknownM * kUnknownM, kUnknownM * kUnknownM, kUnknownRad * kUnknownRad).asDiagonal();
}

}  // namespace

bool MotionModel::trusts_wheel_distance() const {
  return wheels.trust_distance >= kLeastTrust;
}

bool MotionModel::trusts_wheels() const {
  return trusts_wheel_distance() && wheels.trust_turn >= kLeastTrust;
}

MotionInput MotionModel::begin_scan(const ScanTiming& timing, const std::optional<Pose2>& T_odom_base,
                                    const OdometryOptions& options) {
  MotionInput input;
  input.timing = timing;
  variability.set_period(timing.period_s);
  if (options.use_wheels) input.wheel_step = wheels.step(T_odom_base);
  input.seconds = timing.period_s * timing.periods;
  input.twist = twist;
  if (input.wheel_step && wheels.trust_turn >= kLeastTrust && input.seconds > 0.0)
    input.twist.omega = input.wheel_step->theta / input.seconds;
  return input;
}

void MotionModel::forget_speed() {
  step = Pose2{};
  step_covariance = kAfterGap * unknown_step_covariance();
}

void MotionModel::probe(const LocalMap& map, const MapPoints& points, const Pose2& T_map_last, const MotionInput& input,
                        MotionPrediction& best) const {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kProbePoints);
  const Pose2 as_before = scale_motion(step, input.timing.periods);
  best.step = as_before;
  best.score = -1.0;
  const auto consider = [&](const Pose2& candidate, double handicap) {
    const double score = pose_score(map, points, T_map_last * candidate, stride) - handicap;
    if (score > best.score) best.score = score, best.step = candidate;
  };
  consider(as_before, 0.0);
  consider({}, kHandicap);
  if (input.wheel_step) {
    const Pose2& wheel = *input.wheel_step;
    consider(wheel, 0.0);
    consider({-wheel.x, -wheel.y, wheel.theta}, kHandicap);  // cheap encoders do not see which way a wheel turns
  }
  if (best.score >= kMinUsualShare * usual_score) return;
  // None explains the scan as scans usually are: perhaps a turn began.
  const Pose2 centre = best.step;
  for (int k = 1; k <= kTurns; ++k) {
    for (const double side : {-1.0, 1.0})
      consider({centre.x, centre.y, wrap_angle(centre.theta + side * k * kTurnRad)}, kHandicap);
  }
}

PosePrior MotionModel::prior_of(const Pose2& T_map_last, const Pose2& mean, Eigen::Matrix3d covariance, double periods,
                                const SearchPolicy& policy) const {
  const double change_m = std::max(kChangeM, policy.change_m), change_rad = std::max(kChangeRad, policy.change_rad);
  covariance.diagonal() += Eigen::Vector3d(change_m * change_m, change_m * change_m, change_rad * change_rad);
  covariance *= periods * periods;
  PosePrior prior;
  prior.T_map_base = T_map_last * mean;
  // The points of a scan are not independent of each other: the prior is weighed against a share of what they claim.
  prior.information = rotate_information(covariance.inverse() / kMatchTrust, prior.T_map_base.theta);
  return prior;
}

MotionPrediction MotionModel::predict(const LocalMap& map, const MapPoints& points, const Pose2& T_map_last,
                                      const MotionInput& input, const SearchPolicy& policy, bool new_laser,
                                      const OdometryOptions& options) const {
  MotionPrediction expected;
  probe(map, points, T_map_last, input, expected);
  const double periods = input.timing.periods;
  // Robots keep on doing what they did.
  Pose2 mean = scale_motion(options.motion_habits ? learned.expect(step) : step, periods);
  if (!new_laser) mean.theta = expected.step.theta;
  if (input.wheel_step && trusts_wheels()) {
    // Wheels show a change of speed at once.
    mean.x += kWheelShare * (input.wheel_step->x - mean.x);
    mean.y += kWheelShare * (input.wheel_step->y - mean.y);
    if (new_laser) mean = *input.wheel_step;
  }
  expected.prior = prior_of(T_map_last, mean, step_covariance, periods, policy);
  if (!options.motion_habits || (input.wheel_step && trusts_wheel_distance())) return expected;
  const double turn = wrap_angle(expected.prior.T_map_base.theta - T_map_last.theta);
  if (const std::optional<MotionPrior::Step> usual = learned.prior_for(turn / periods)) {
    Eigen::Matrix3d covariance = step_covariance;
    covariance.topLeftCorner<2, 2>() = usual->covariance;
    covariance.topRightCorner<2, 1>().setZero();
    covariance.bottomLeftCorner<1, 2>().setZero();
    expected.learned =
        prior_of(T_map_last, {periods * usual->x, periods * usual->y, turn}, covariance, periods, policy);
  }
  return expected;
}

MotionInput MotionModel::with_scans_missing(MotionInput input, const Pose2& moved) const {
  if (!input.timing.unsteady) return input;
  const double usual = learned.driving.x.count > 0 ? std::abs(learned.driving.x.mean) : 0.0;
  const double one = std::max({kLeastStepM, usual, std::hypot(step.x, step.y)});
  const double steps = std::round(std::hypot(moved.x, moved.y) / one);
  if (steps < kLeastMissing) return input;
  input.timing.periods = std::min(steps, ScanTiming::kMostPeriods);
  input.seconds = input.timing.period_s * input.timing.periods;
  return input;
}

MotionUpdate MotionModel::fuse(const Registration& found, const PosePrior& prior, const Pose2& moved,
                               const MotionInput& input) {
  MotionUpdate update;
  const double theta = found.T_map_base.theta;
  update.moved = moved;
  update.seen = kMatchTrust * rotate_information(found.information, -theta);
  update.known = update.seen + kMatchTrust * rotate_information(prior.information, -theta);
  if (input.wheel_step) {
    update.wheels = wheels.judge(*input.wheel_step, moved, step_covariance_of(update.seen, moved.theta));
    update.moved = fuse_wheels(moved, *input.wheel_step, update.known);
  }
  return update;
}

Pose2 MotionModel::fuse_wheels(const Pose2& moved, const Pose2& wheel_step, Eigen::Matrix3d& known) const {
  if (!trusts_wheels()) return moved;
  const double sigma_m = (kWheelM + kWheelPerM * std::hypot(wheel_step.x, wheel_step.y)) / wheels.trust_distance;
  const double sigma_rad = (kWheelRad + kWheelPerRad * std::abs(wheel_step.theta)) / wheels.trust_turn;
  const Eigen::Vector3d variance(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad);
  // In the frame of the new base, as `known` is.
  const Pose2 off = moved.inverse() * wheel_step;
  const Eigen::Vector3d d(off.x, off.y, off.theta);
  const Eigen::Matrix3d spread = known.inverse() + Eigen::Matrix3d(variance.asDiagonal());
  const double contradiction = d.dot(spread.inverse() * d);
  if (contradiction > kContradiction) return moved;
  // Errors of wheels are not normally distributed: what differs from what was seen is more likely slip than chance, and
  // weighs less the more it differs.
  const double weight = 1.0 / ((1.0 + contradiction) * (1.0 + contradiction));
  const Eigen::Matrix3d told = (weight * variance.cwiseInverse()).asDiagonal();
  const Eigen::Matrix3d sum = known + told;
  const Eigen::Vector3d shift = sum.inverse() * (told * d);
  known = sum;
  return moved * Pose2{shift.x(), shift.y(), shift.z()};
}

void MotionModel::correct(const MotionUpdate& update, double prediction_score, const MotionInput& input) {
  const double periods = input.timing.periods;
  step_covariance = update.known.inverse() / (periods * periods);
  bound_translation(step_covariance, kMostStepM);
  variability.add(scale_motion(step, periods).inverse() * update.moved);
  usual_score = kMemoryOfUsual * usual_score + (1.0 - kMemoryOfUsual) * std::max(prediction_score, 0.0);
  step = scale_motion(update.moved, 1.0 / periods);
  learned.learn(step, determines_position(update.seen));
}

Pose2 MotionModel::step_without_match(const Pose2& predicted, const MotionInput& input) {
  const bool by_wheels = input.wheel_step && trusts_wheel_distance();
  step = scale_motion(step, kSlowDown);
  step_covariance = unknown_step_covariance();
  return by_wheels ? *input.wheel_step : predicted;
}

void MotionModel::set_twist(const Pose2& moved, const MotionInput& input) {
  if (input.seconds > 0.0) twist = mean_twist(moved, input.seconds);
}

void RelativeUncertainty::grow(const MotionUpdate& update, std::size_t map_keyframes) {
  const Eigen::Matrix3d& seen = update.seen;
  const Eigen::Matrix3d only_step = update.known - seen;
  const double turn = -update.moved.theta;
  const Eigen::Matrix3d step = (only_step + Eigen::Matrix3d(Eigen::Vector3d(1.0, 1.0, 1.0).asDiagonal())).inverse();
  Eigen::Matrix3d by_motion = rotate_information(covariance, turn);
  by_motion += step;
  const Eigen::Matrix3d motion_information = by_motion.inverse();
  covariance = (seen + motion_information).inverse();
  covariance = 0.5 * (covariance + covariance.transpose().eval());
  // The new error is a mean of that of the match and that of the motion, with these weights.
  const Eigen::Matrix3d of_match = covariance * seen, of_motion = covariance * motion_information;
  const double left = 2.0 / (static_cast<double>(map_keyframes) + 1.0);
  drift = left * left * of_match * covariance +
          of_motion * (rotate_information(drift, turn) + step) * of_motion.transpose();
  drift = 0.5 * (drift + drift.transpose().eval());
}

void RelativeUncertainty::grow_unseen() {
  covariance += unknown_step_covariance();
  drift += unknown_step_covariance();
}

}  // namespace phasescan
