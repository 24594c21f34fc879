#include "odometry/motion_prior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
// Relief: of lines of five hits up to so long; more than so high is no relief but a corner [m].
constexpr float kLongestLineM = 1.0F, kHighestReliefM = 0.08F;
constexpr std::size_t kLeastBeams = 40;  // in common with the scan before
// A step [m], [rad] shorter than the first pair is rest, beyond the second driving, and turning.
constexpr double kRestM = 0.006, kRestRad = 0.003, kMovingM = 0.03, kTurningRad = 0.06;
// What is usual: scans until it counts, and the weight of the past.
constexpr std::size_t kLeastSeen = 20;
constexpr double kMemoryOfMean = 0.98;
// Rest is told from motion where the two have been this far apart, and a scan within this share of that of rest.
constexpr double kLeastContrast = 0.4, kNearStill = 0.35;
constexpr int kInARow = 2;          // one scan may be like the last by chance
constexpr double kBack = 0.02;      // share of the way back to the usual step, per scan
constexpr double kAtRestM = 0.005;  // [m] standard deviation of the motion of one at rest

}  // namespace

std::optional<double> ReliefCorrelation::add(const SurfacePoints& surface) {
  std::vector<float> now(
      surface.beam.empty() ? 0
                           : 1 + static_cast<std::size_t>(*std::max_element(surface.beam.begin(), surface.beam.end())),
      kNothing);
  for (std::size_t i = 2; i + 2 < surface.size(); ++i) {
    if (std::abs(surface.beam[i + 2] - surface.beam[i - 2]) != 4) continue;
    const SurfacePoint &a = surface[i - 2], &b = surface[i + 2], &p = surface[i];
    const float dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
    if (!(length > 0.0F) || length > kLongestLineM) continue;
    const float out = (dx * (p.y - a.y) - dy * (p.x - a.x)) / length;
    if (std::fabs(out) < kHighestReliefM) now[static_cast<std::size_t>(surface.beam[i])] = out;
  }
  double aa = 0.0, bb = 0.0, ab = 0.0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < std::min(relief.size(), now.size()); ++i) {
    const double a = static_cast<double>(relief[i]), b = static_cast<double>(now[i]);
    if (std::isnan(a) || std::isnan(b)) continue;
    aa += a * a, bb += b * b, ab += a * b;
    ++common;
  }
  relief.swap(now);
  if (common < kLeastBeams || !(aa * bb > 0.0)) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

void MotionPrior::Usual::add(double value) {
  // The plain mean of the first, then one that forgets.
  ++count;
  mean += std::max(1.0 - kMemoryOfMean, 1.0 / static_cast<double>(count)) * (value - mean);
}

bool MotionPrior::alike(double value) const {
  if (likeness_still.count < kLeastSeen || likeness_moving.count < kLeastSeen) return false;
  const double contrast = likeness_still.mean - likeness_moving.mean;
  return contrast > kLeastContrast && value > likeness_still.mean - kNearStill * contrast;
}

void MotionPrior::observe(const SurfacePoints& surface) {
  likeness = relief.add(surface);
  alike_in_a_row = likeness && alike(*likeness) ? alike_in_a_row + 1 : 0;
}

MotionState MotionPrior::state_of(double turn) const {
  if (alike_in_a_row >= kInARow) return MotionState::kStill;
  return std::abs(turn) > kTurningRad ? MotionState::kTurning : MotionState::kDriving;
}

std::optional<MotionPrior::Step> MotionPrior::prior_for(double turn) const {
  const MotionState now = state_of(turn);
  if (now == MotionState::kStill) return Step{0.0, 0.0, kAtRestM * kAtRestM * Eigen::Matrix2d::Identity()};
  // Only a change asks for it: what drives, drives on as fast as it did.
  if (now == last) return std::nullopt;
  const UsualStep& usual = now == MotionState::kTurning ? turning : driving;
  if (usual.x.count < kLeastSeen) return std::nullopt;
  Step out{usual.x.mean, usual.y.mean, Eigen::Matrix2d::Zero()};
  out.covariance(0, 0) = std::max(0.0, usual.xx.mean - usual.x.mean * usual.x.mean);
  out.covariance(1, 1) = std::max(0.0, usual.yy.mean - usual.y.mean * usual.y.mean);
  return out;
}

Pose2 MotionPrior::expect(const Pose2& step) const {
  if (seen || last == MotionState::kStill) return step;
  const UsualStep& usual = last == MotionState::kTurning ? turning : driving;
  if (usual.x.count < kLeastSeen) return step;
  return {step.x + kBack * (usual.x.mean - step.x), step.y + kBack * (usual.y.mean - step.y), step.theta};
}

void MotionPrior::learn(const Pose2& step, bool determined) {
  seen = determined;
  last = state_of(step.theta);
  if (!seen) return;
  const double distance = std::hypot(step.x, step.y);
  if (likeness && distance < kRestM && std::abs(step.theta) < kRestRad) likeness_still.add(*likeness);
  if (likeness && distance > kMovingM) likeness_moving.add(*likeness);
  if (distance < kRestM && std::abs(step.theta) < kTurningRad) return;
  UsualStep& usual = std::abs(step.theta) > kTurningRad ? turning : driving;
  usual.x.add(step.x);
  usual.y.add(step.y);
  usual.xx.add(step.x * step.x);
  usual.yy.add(step.y * step.y);
}

}  // namespace phasescan
