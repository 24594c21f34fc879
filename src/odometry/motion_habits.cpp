#include "odometry/motion_habits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kLeastBeams = 40;
constexpr float kLongestLineM = 1.0F, kHighestReliefM = 0.08F;  // a line of five hits; more is no relief but a corner
constexpr std::size_t kLeastSeen = 20;                          // scans to call something usual
constexpr double kHabitSlow = 0.98;                             // weight of the past in what is usual
constexpr double kRestM = 0.006, kRestRad = 0.003, kMovingM = 0.03, kTurningRad = 0.06;
// Rest is told from motion where the two have been this far apart, and a scan within this share of that of rest.
constexpr double kLeastContrast = 0.4, kNearStill = 0.35;
constexpr int kInARow = 2;          // one scan may be like the last by chance
constexpr double kBack = 0.02;      // share of the way back to the usual step, per scan
constexpr double kAtRestM = 0.005;  // standard deviation of the motion of one at rest

}  // namespace

std::optional<double> ReliefWitness::add(const SurfacePoints& surface) {
  last_.swap(now_);
  now_.assign(surface.beam.empty()
                  ? 0
                  : 1 + static_cast<std::size_t>(*std::max_element(surface.beam.begin(), surface.beam.end())),
              kNothing);
  for (std::size_t i = 2; i + 2 < surface.size(); ++i) {
    if (std::abs(surface.beam[i + 2] - surface.beam[i - 2]) != 4) continue;
    const SurfacePoint &a = surface[i - 2], &b = surface[i + 2], &p = surface[i];
    const float dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
    if (!(length > 0.0F) || length > kLongestLineM) continue;
    const float out = (dx * (p.y - a.y) - dy * (p.x - a.x)) / length;
    if (std::fabs(out) < kHighestReliefM) now_[static_cast<std::size_t>(surface.beam[i])] = out;
  }
  double aa = 0.0, bb = 0.0, ab = 0.0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < std::min(last_.size(), now_.size()); ++i) {
    const double a = static_cast<double>(last_[i]), b = static_cast<double>(now_[i]);
    if (std::isnan(a) || std::isnan(b)) continue;
    aa += a * a, bb += b * b, ab += a * b;
    ++common;
  }
  if (common < kLeastBeams || !(aa * bb > 0.0)) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

void MotionHabits::Usual::add(double value) {
  // The plain mean of the first, then one that forgets.
  ++count;
  mean += std::max(1.0 - kHabitSlow, 1.0 / static_cast<double>(count)) * (value - mean);
}

bool MotionHabits::alike(double likeness) const {
  if (likeness_still_.count < kLeastSeen || likeness_moving_.count < kLeastSeen) return false;
  const double contrast = likeness_still_.mean - likeness_moving_.mean;
  return contrast > kLeastContrast && likeness > likeness_still_.mean - kNearStill * contrast;
}

void MotionHabits::add(const SurfacePoints& surface) {
  likeness_ = relief_.add(surface);
  alike_in_a_row_ = likeness_ && alike(*likeness_) ? alike_in_a_row_ + 1 : 0;
}

MotionHabits::Gait MotionHabits::gait(double turn) const {
  if (alike_in_a_row_ >= kInARow) return Gait::kStill;
  return std::abs(turn) > kTurningRad ? Gait::kTurning : Gait::kDriving;
}

std::optional<MotionHabits::Assumption> MotionHabits::assume(double turn) const {
  const Gait now = gait(turn);
  if (now == Gait::kStill) return Assumption{0.0, 0.0, kAtRestM * kAtRestM * Eigen::Matrix2d::Identity()};
  // Only a change asks for it: what drives, drives on as fast as it did.
  if (now == last_) return std::nullopt;
  const UsualStep& usual = now == Gait::kTurning ? turning_ : driving_;
  if (usual.x.count < kLeastSeen) return std::nullopt;
  Assumption out{usual.x.mean, usual.y.mean, Eigen::Matrix2d::Zero()};
  out.covariance(0, 0) = std::max(0.0, usual.xx.mean - usual.x.mean * usual.x.mean);
  out.covariance(1, 1) = std::max(0.0, usual.yy.mean - usual.y.mean * usual.y.mean);
  return out;
}

Pose2 MotionHabits::expect(const Pose2& step) const {
  if (seen_ || last_ == Gait::kStill) return step;
  const UsualStep& usual = last_ == Gait::kTurning ? turning_ : driving_;
  if (usual.x.count < kLeastSeen) return step;
  return {step.x + kBack * (usual.x.mean - step.x), step.y + kBack * (usual.y.mean - step.y), step.theta};
}

void MotionHabits::learn(const Pose2& step, bool seen) {
  seen_ = seen;
  last_ = gait(step.theta);
  if (!seen) return;
  const double distance = std::hypot(step.x, step.y);
  if (likeness_ && distance < kRestM && std::abs(step.theta) < kRestRad) likeness_still_.add(*likeness_);
  if (likeness_ && distance > kMovingM) likeness_moving_.add(*likeness_);
  if (distance < kRestM && std::abs(step.theta) < kTurningRad) return;
  UsualStep& usual = std::abs(step.theta) > kTurningRad ? turning_ : driving_;
  usual.x.add(step.x);
  usual.y.add(step.y);
  usual.xx.add(step.x * step.x);
  usual.yy.add(step.y * step.y);
}

}  // namespace phasescan
