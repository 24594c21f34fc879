/// How the sensor moves: tours, circles, back and forth, given polylines, with limits on speed and acceleration and
/// with jitter.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "phasescan/core/options.hpp"
#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"
#include "sim/world.hpp"

namespace phasescan::sim {

enum class PathKind {
  kTour,          ///< through all rooms that can be reached and back to the start, collision-free
  kCircle,        ///< with the given speed and turn rate, where it fits
  kBackAndForth,  ///< forwards and backwards along the longest free line found
  kTurn,          ///< turning on the spot
  kStand,         ///< standing still
};

}  // namespace phasescan::sim

namespace phasescan {
template <>
std::span<const std::string_view> enum_names<sim::PathKind>();
}  // namespace phasescan

namespace phasescan::sim {

struct PathOptions {
  PathKind kind = PathKind::kTour;
  double speed_mps = 0.3;
  double turn_rate_dps = 45.0;
  double acceleration_mps2 = 1.0;
  double turn_acceleration_dps2 = 360.0;
  double clearance_m = 0.22;
  double duration_s = 0.0;
  double jitter_m = 0.0;
  double jitter_deg = 0.0;
  double stop_every_m = 0.0;
  double stop_s = 3.0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("kind", self.kind, OptionInfo{"", "tour, circle, back-and-forth, turn or stand"});
    v("speed_mps", self.speed_mps, OptionInfo{"m/s", "linear speed, at most", 0, 20});
    v("turn_rate_dps", self.turn_rate_dps, OptionInfo{"deg/s", "angular speed, at most", 0, 1000});
    v("acceleration_mps2", self.acceleration_mps2, OptionInfo{"m/s^2", "linear, at most", 0.01, 100});
    v("turn_acceleration_dps2", self.turn_acceleration_dps2, OptionInfo{"deg/s^2", "angular, at most", 1, 100000});
    v("clearance_m", self.clearance_m, OptionInfo{"m", "of the planned way to every surface", 0.05, 10});
    v("duration_s", self.duration_s,
      OptionInfo{"s", "0: one round (tour), else 60 s; longer tours go round again by another way", 0, 2e5});
    v("jitter_m", self.jitter_m, OptionInfo{"m", "vibration, standard deviation a axis", 0, 1});
    v("jitter_deg", self.jitter_deg, OptionInfo{"deg", "vibration of the heading, standard deviation", 0, 90});
    v("stop_every_m", self.stop_every_m,
      OptionInfo{"m", "stops after each such piece of a tour or polyline; 0: never", 0, 1e4});
    v("stop_s", self.stop_s, OptionInfo{"s", "and stands so long", 0, 3600});
  }
};

/// Vibration: a sum of sines of 5-25 Hz with random phases.
class Jitter {
 public:
  Jitter() = default;
  Jitter(double sigma_m, double sigma_deg, Random& random);
  Pose2 at(double t) const;

 private:
  struct Wave {
    double rate, phase, amplitude;
  };
  std::vector<Wave> waves_[3];
};

/// A motion: the pose of the sensor at any time from 0 to duration().
class Path {
 public:
  /// Plans a path in a world. The same path for the same world, options and seed.
  /// @throws std::invalid_argument for options out of bounds, or where the world has no room for such a path.
  Path(const World& world, const PathOptions& options, std::uint64_t seed);

  /// Drives along a polyline: turns towards each leg, slows down for corners, stops at the end.
  /// @throws std::invalid_argument for fewer than two points or options out of bounds.
  Path(std::span<const Eigen::Vector2d> points, const PathOptions& options, std::uint64_t seed);

  double duration() const { return static_cast<double>(poses_.size() - 1) * kStep_s; }
  /// Length of the way, jitter apart [m].
  double length() const;
  /// T_world_laser, jitter included; times outside are clamped to the ends.
  Pose2 pose_at(double t) const;
  /// The motion in the body frame at a time, jitter apart.
  Twist2 twist_at(double t) const;

 private:
  static constexpr double kStep_s = 0.01;
  Pose2 smooth_at(double t) const;
  void follow(std::span<const Eigen::Vector2d> points, const PathOptions& options);
  void command(double speed, double turn_rate, double seconds, const PathOptions& options);
  void step(double speed, double turn_rate, const PathOptions& options);

  std::vector<Pose2> poses_;
  double speed_ = 0.0;      ///< at the end so far
  double turn_rate_ = 0.0;  ///< [rad/s]
  Jitter jitter_;
};

}  // namespace phasescan::sim
