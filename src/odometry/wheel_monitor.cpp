#include "odometry/wheel_monitor.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

constexpr double kJumpM = 2.0, kJumpRad = 2.0;  // [m], [rad] between scans: an encoder that was reset
constexpr double kMemoryOfTrust = 0.85;         // weight of the past in the trust, per judged step
constexpr double kJumpTrust = 0.5;              // what a jump leaves of it
// What a step may be off by and still agree: standing [m], [rad], and in share of the motion. Cheap robots' wheels.
constexpr double kAllowedM = 0.03, kAllowedRad = 0.03, kAllowedShare = 0.25;
constexpr double kTurningM = 0.01;        // a step of wheels that turn
constexpr double kLeastReversedM = 0.03;  // shorter steps point nowhere

}  // namespace

std::optional<Pose2> WheelOdometryMonitor::step(const std::optional<Pose2>& T_odom_base) {
  const std::optional<Pose2> before = last;
  last = T_odom_base && T_odom_base->is_finite() ? T_odom_base : std::nullopt;
  if (!before || !last) return std::nullopt;
  const Pose2 moved = before->inverse() * *last;
  if (std::hypot(moved.x, moved.y) > kJumpM || std::abs(moved.theta) > kJumpRad) {
    ++counts.steps;
    ++counts.jumped;
    trust_distance *= kJumpTrust;
    trust_turn *= kJumpTrust;
    return std::nullopt;
  }
  return moved;
}

WheelConsistency WheelOdometryMonitor::judge(const Pose2& wheel_step, const Pose2& found_step,
                                             const Eigen::Matrix2d& uncertainty) {
  ++counts.steps;
  const double distance = std::hypot(found_step.x, found_step.y), turned = std::hypot(wheel_step.x, wheel_step.y);
  if (turned > kTurningM) {
    counts.wheels_m += turned;
    counts.scans_m += distance;
  }
  const double allowed_m = kAllowedM + kAllowedShare * distance,
               allowed_rad = kAllowedRad + kAllowedShare * std::abs(found_step.theta);
  // How far off, as far as the scans can tell: along a bare corridor they cannot.
  const double allowed_squared = allowed_m * allowed_m;
  const Eigen::Matrix2d weight = (Eigen::Matrix2d::Identity() + uncertainty / allowed_squared).inverse();
  const auto distance_seen = [&weight](double x, double y) {
    const Eigen::Vector2d d(x, y);
    return std::sqrt(std::max(0.0, d.dot(weight * d)));
  };
  const double off = distance_seen(wheel_step.x - found_step.x, wheel_step.y - found_step.y);
  const double off_mirrored = distance_seen(wheel_step.x + found_step.x, wheel_step.y + found_step.y);
  // A comparison counts as much as was seen of the direction driven.
  const Eigen::Vector2d driven(wheel_step.x, wheel_step.y);
  const double seen = driven.norm() > 1e-9 ? driven.normalized().dot(weight * driven.normalized()) : 1.0;
  const double news = (1.0 - kMemoryOfTrust) * seen;
  const bool distance_right = off < allowed_m,
             turn_right = std::abs(wrap_angle(wheel_step.theta - found_step.theta)) < allowed_rad;
  trust_distance += news * ((distance_right ? 1.0 : 0.0) - trust_distance);
  trust_turn = kMemoryOfTrust * trust_turn + (turn_right ? 1.0 - kMemoryOfTrust : 0.0);
  if (distance_right && turn_right) {
    ++counts.agreed;
    return WheelConsistency::kAgrees;
  }
  if (!distance_right && turn_right && off_mirrored < allowed_m && distance > kLeastReversedM) {
    ++counts.reversed;
    return WheelConsistency::kReversed;
  }
  ++counts.slipped;
  return WheelConsistency::kSlips;
}

}  // namespace phasescan
