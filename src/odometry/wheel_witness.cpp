#include "odometry/wheel_witness.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr double kJumpM = 2.0, kJumpRad = 2.0;
constexpr double kMemory = 0.85;  // weight of the past in the trust, per judged step

}  // namespace

std::optional<Pose2> WheelWitness::step(const std::optional<Pose2>& T_odom_base) {
  const std::optional<Pose2> before = last_;
  last_ = T_odom_base && T_odom_base->is_finite() ? T_odom_base : std::nullopt;
  if (!before || !last_) return std::nullopt;
  const Pose2 moved = before->inverse() * *last_;
  if (std::hypot(moved.x, moved.y) > kJumpM || std::abs(moved.theta) > kJumpRad) {
    ++counts_.steps;
    ++counts_.jumped;
    trust_distance_ *= 0.5;
    trust_turn_ *= 0.5;
    return std::nullopt;
  }
  return moved;
}

WheelVerdict WheelWitness::judge(const Pose2& wheel_step, const Pose2& found_step, const Eigen::Matrix2d& doubt) {
  ++counts_.steps;
  const double distance = std::hypot(found_step.x, found_step.y);
  const double allowed_m = 0.03 + 0.25 * distance, allowed_rad = 0.03 + 0.25 * std::abs(found_step.theta);
  // How far off, as far as the scans can tell: along a bare corridor they cannot.
  const double allowed_squared = allowed_m * allowed_m;
  const Eigen::Matrix2d weight = (Eigen::Matrix2d::Identity() + doubt / allowed_squared).inverse();
  const auto distance_seen = [&weight](double x, double y) {
    const Eigen::Vector2d d(x, y);
    return std::sqrt(std::max(0.0, d.dot(weight * d)));
  };
  const double off = distance_seen(wheel_step.x - found_step.x, wheel_step.y - found_step.y);
  const double off_mirrored = distance_seen(wheel_step.x + found_step.x, wheel_step.y + found_step.y);
  // A verdict counts as much as was seen of the direction driven.
  const Eigen::Vector2d driven(wheel_step.x, wheel_step.y);
  const double seen = driven.norm() > 1e-9 ? driven.normalized().dot(weight * driven.normalized()) : 1.0;
  const double news = (1.0 - kMemory) * seen;
  const bool distance_right = off < allowed_m,
             turn_right = std::abs(wrap_angle(wheel_step.theta - found_step.theta)) < allowed_rad;
  trust_distance_ += news * ((distance_right ? 1.0 : 0.0) - trust_distance_);
  trust_turn_ = kMemory * trust_turn_ + (turn_right ? 1.0 - kMemory : 0.0);
  if (distance_right && turn_right) {
    ++counts_.agreed;
    return WheelVerdict::kAgrees;
  }
  if (!distance_right && turn_right && off_mirrored < allowed_m && distance > 0.03) {
    ++counts_.reversed;
    return WheelVerdict::kReversed;
  }
  ++counts_.slipped;
  return WheelVerdict::kSlip;
}

}  // namespace phasescan
