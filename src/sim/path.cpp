#include "sim/path.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/routes.hpp"

namespace phasescan {

template <>
std::span<const std::string_view> enum_names<sim::PathKind>() {
  static constexpr std::string_view names[] = {"tour", "circle", "back-and-forth", "turn", "stand"};
  return names;
}

}  // namespace phasescan

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

constexpr double kDefaultDuration_s = 60.0;

void check(const PathOptions& options) {
  validate_options("path", options);
  const bool moves = options.kind != PathKind::kStand;
  if (moves && options.kind != PathKind::kTurn && options.speed_mps <= 0.0) {
    throw std::invalid_argument("path.speed_mps: must be above 0 to move");
  }
  const bool turns =
      options.kind == PathKind::kTour || options.kind == PathKind::kCircle || options.kind == PathKind::kTurn;
  if (turns && options.turn_rate_dps <= 0.0) throw std::invalid_argument("path.turn_rate_dps: must be above 0 to turn");
}

/// A polyline by arc length with a speed for each place: bends slow down, and braking begins before them.
class SpeedProfile {
 public:
  SpeedProfile(std::span<const Vector2d> points, const PathOptions& options)
      : points_(points.begin(), points.end()), along_(points.size(), 0.0) {
    for (std::size_t i = 1; i < points_.size(); ++i) along_[i] = along_[i - 1] + (points_[i] - points_[i - 1]).norm();
    const auto count = static_cast<std::size_t>(length() / kGrain_m) + 2;
    speeds_.resize(count);
    constexpr double kWindow_m = 0.25, kCrawl = 0.15, kMargin = 0.6;
    const double top_turn = deg_to_rad(options.turn_rate_dps);
    for (std::size_t k = 0; k < count; ++k) {
      const double s = static_cast<double>(k) * kGrain_m;
      const Vector2d before = point(s) - point(s - kWindow_m), after = point(s + kWindow_m) - point(s);
      const double bend = before.norm() > 0.0 && after.norm() > 0.0
                              ? std::abs(std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after)))
                              : 0.0;
      const double fit = bend > 0.0 ? kMargin * top_turn * kWindow_m / bend : options.speed_mps;
      speeds_[k] = std::min(options.speed_mps, std::max(fit, std::min(kCrawl, 0.5 * options.speed_mps)));
    }
    for (std::size_t k = count - 1; k-- > 0;) {
      speeds_[k] =
          std::min(speeds_[k], std::sqrt(speeds_[k + 1] * speeds_[k + 1] + 1.2 * options.acceleration_mps2 * kGrain_m));
    }
  }

  double length() const { return along_.back(); }

  Vector2d point(double s) const {
    const auto next = static_cast<std::size_t>(std::upper_bound(along_.begin(), along_.end(), s) - along_.begin());
    if (next == 0) return points_.front();
    if (next >= points_.size()) return points_.back();
    const double share = (s - along_[next - 1]) / (along_[next] - along_[next - 1]);
    return points_[next - 1] + share * (points_[next] - points_[next - 1]);
  }

  double speed(double s) const {
    const double at = std::clamp(s / kGrain_m, 0.0, static_cast<double>(speeds_.size() - 1));
    return speeds_[static_cast<std::size_t>(at)];
  }

 private:
  static constexpr double kGrain_m = 0.05;
  std::vector<Vector2d> points_;
  std::vector<double> along_;
  std::vector<double> speeds_;
};

}  // namespace

Jitter::Jitter(double sigma_m, double sigma_deg, Random& random) {
  constexpr int kWaves = 6;
  const double sigmas[3] = {sigma_m, sigma_m, deg_to_rad(sigma_deg)};
  for (int axis = 0; axis < 3; ++axis) {
    if (sigmas[axis] <= 0.0) continue;
    for (int i = 0; i < kWaves; ++i) {
      // Amplitudes so that the variances of all waves add up to sigma^2.
      waves_[axis].push_back(
          {kTwoPi * random.uniform(5.0, 25.0), random.uniform(0.0, kTwoPi), sigmas[axis] * std::sqrt(2.0 / kWaves)});
    }
  }
}

Pose2 Jitter::at(double t) const {
  double sum[3] = {0.0, 0.0, 0.0};
  for (int axis = 0; axis < 3; ++axis) {
    for (const Wave& w : waves_[axis]) sum[axis] += w.amplitude * std::sin(w.rate * t + w.phase);
  }
  return {sum[0], sum[1], sum[2]};
}

Path::Path(const World& world, const PathOptions& options, std::uint64_t seed) {
  check(options);
  Random random(seed);
  jitter_ = Jitter(options.jitter_m, options.jitter_deg, random);
  const double duration = options.duration_s > 0.0 ? options.duration_s : kDefaultDuration_s;
  switch (options.kind) {
    case PathKind::kTour: {
      TourPlanner planner(world, options.clearance_m, random);
      do {
        const std::vector<Vector2d> round = planner.next_round(random);
        if (poses_.empty())
          poses_.push_back(
              {round[0].x(), round[0].y(), std::atan2(round[1].y() - round[0].y(), round[1].x() - round[0].x())});
        follow(round, options);
      } while (this->duration() < options.duration_s);
      break;
    }
    case PathKind::kCircle: {
      const double turn_rate = deg_to_rad(options.turn_rate_dps) * (random.chance(0.5) ? 1.0 : -1.0);
      poses_.push_back(find_circle(world, options.speed_mps / turn_rate, options.clearance_m, random));
      command(options.speed_mps, turn_rate, duration, options);
      break;
    }
    case PathKind::kBackAndForth: {
      const auto [a, b] = find_line(world, options.clearance_m, random);
      const double length = (b - a).norm();
      poses_.push_back({a.x(), a.y(), std::atan2(b.y() - a.y(), b.x() - a.x())});
      const double ramp = options.speed_mps * options.speed_mps / options.acceleration_mps2;
      const double top = ramp < length ? options.speed_mps : std::sqrt(length * options.acceleration_mps2);
      const double cruise = (length - top * top / options.acceleration_mps2) / top + top / options.acceleration_mps2;
      for (double sign = 1.0; this->duration() < duration; sign = -sign) {
        command(sign * top, 0.0, cruise, options);
        command(0.0, 0.0, top / options.acceleration_mps2 + 0.5, options);
      }
      break;
    }
    case PathKind::kTurn:
    case PathKind::kStand: {
      const auto at = find_point(world, options.clearance_m, random);
      poses_.push_back({at.x(), at.y(), random.uniform(-kPi, kPi)});
      command(0.0, options.kind == PathKind::kTurn ? deg_to_rad(options.turn_rate_dps) : 0.0, duration, options);
      break;
    }
  }
  if (options.duration_s > 0.0)
    poses_.resize(std::min(poses_.size(), static_cast<std::size_t>(options.duration_s / kStep_s) + 2));
}

Path::Path(std::span<const Vector2d> points, const PathOptions& options, std::uint64_t seed) {
  check(options);
  if (points.size() < 2) throw std::invalid_argument("path.points: fewer than two");
  Random random(seed);
  jitter_ = Jitter(options.jitter_m, options.jitter_deg, random);
  poses_.push_back(
      {points[0].x(), points[0].y(), std::atan2(points[1].y() - points[0].y(), points[1].x() - points[0].x())});
  follow(points, options);
}

void Path::step(double speed, double turn_rate, const PathOptions& options) {
  const double dv = options.acceleration_mps2 * kStep_s, dw = deg_to_rad(options.turn_acceleration_dps2) * kStep_s;
  speed_ += std::clamp(speed - speed_, -dv, dv);
  turn_rate_ += std::clamp(turn_rate - turn_rate_, -dw, dw);
  poses_.push_back(poses_.back() * exp_twist({speed_, 0.0, turn_rate_}, kStep_s));
}

void Path::command(double speed, double turn_rate, double seconds, const PathOptions& options) {
  const int steps = static_cast<int>(std::lround(seconds / kStep_s));
  for (int i = 0; i < steps; ++i) step(speed, turn_rate, options);
}

void Path::follow(std::span<const Vector2d> points, const PathOptions& options) {
  // Pure pursuit [Coulter92] of a point a little ahead, at a speed planned so that bends are met slowly enough.
  constexpr double kAhead_m = 0.18, kArrived_m = 0.03, kGain = 4.0;
  const double top_turn = deg_to_rad(options.turn_rate_dps);
  const SpeedProfile profile(points, options);
  const double end = profile.length();
  double s = 0.0, since_stop = 0.0;
  // Ends in any case: a robot that has not arrived after this many steps is going round its goal.
  const double generous =
      60.0 + 10.0 * end / options.speed_mps + 10.0 * static_cast<double>(points.size()) * kPi / top_turn;
  const auto most = static_cast<std::size_t>(generous / kStep_s);
  for (std::size_t i = 0; i < most; ++i) {
    const Pose2& pose = poses_.back();
    while (s < end && (profile.point(s) - pose.translation()).norm() < kAhead_m) s = std::min(s + 0.005, end);
    const Vector2d to = pose.inverse() * profile.point(s);
    const double left = (points.back() - pose.translation()).norm();
    if (s >= end && (left < kArrived_m || to.x() < 0.0)) break;
    const double error = std::atan2(to.y(), to.x());
    const double facing = std::max(0.0, std::cos(std::min(1.5 * std::abs(error), 0.5 * kPi)));
    const double stop = std::sqrt(1.6 * options.acceleration_mps2 * (end - s + to.norm()));
    const double turn_stop = std::sqrt(2.0 * deg_to_rad(options.turn_acceleration_dps2) * std::abs(error));
    const double turn = std::clamp(kGain * error, -std::min(top_turn, turn_stop), std::min(top_turn, turn_stop));
    step(std::min({profile.speed(s - kAhead_m), profile.speed(s), stop}) * facing * facing, turn, options);
    since_stop += speed_ * kStep_s;
    if (options.stop_every_m > 0.0 && since_stop >= options.stop_every_m) {
      while (speed_ != 0.0 || turn_rate_ != 0.0) step(0.0, 0.0, options);
      command(0.0, 0.0, options.stop_s, options);
      since_stop = 0.0;
    }
  }
  while (speed_ != 0.0 || turn_rate_ != 0.0) step(0.0, 0.0, options);
}

double Path::length() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < poses_.size(); ++i) sum += translation_distance(poses_[i - 1], poses_[i]);
  return sum;
}

Pose2 Path::smooth_at(double t) const {
  const double at = std::clamp(t / kStep_s, 0.0, static_cast<double>(poses_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), poses_.size() - 1);
  if (i + 1 >= poses_.size()) return poses_.back();
  return poses_[i] * exp_twist(log_pose(poses_[i].inverse() * poses_[i + 1]), at - static_cast<double>(i));
}

Pose2 Path::pose_at(double t) const {
  return smooth_at(t) * jitter_.at(t);
}

Twist2 Path::twist_at(double t) const {
  const Twist2 step = log_pose(smooth_at(t - 0.5 * kStep_s).inverse() * smooth_at(t + 0.5 * kStep_s));
  return {step.vx / kStep_s, step.vy / kStep_s, step.omega / kStep_s};
}

}  // namespace phasescan::sim
