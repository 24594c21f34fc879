#include "sim/drive.hpp"

#include <algorithm>
#include <cmath>

#include "sim/ray_caster.hpp"
#include "sim/furniture.hpp"
#include "sim/wheel_odometry.hpp"

namespace phasescan::sim {
namespace {

/// Somebody on a round of their own, over and over.
struct Person {
  Path path;
  Shape body;

  Pose2 at(double t) const { return path.pose_at(std::fmod(t, path.duration())); }
};

constexpr double kStepAside_m = 0.4;

}  // namespace

struct Drive::Impl {
  RayCaster caster;
  LidarOptions lidar;
  Path path;
  DriveOptions options;
  std::uint64_t seed;
  std::vector<Person> people;
  WheelOdometry odometry;
  std::size_t done = 0;
  std::size_t total = 0;

  Impl(const World& world, const LidarOptions& lidar_options, Path way, const DriveOptions& drive_options,
       std::uint64_t drive_seed)
      : caster(world.shape),
        lidar(lidar_options),
        path(std::move(way)),
        options(drive_options),
        seed(drive_seed),
        odometry({options.odometry_scale, options.odometry_noise, options.odometry_slip_per_min},
                 Random::derive(drive_seed, 1)) {
    validate_options("sensor", lidar);
    validate_options("drive", options);
    total = static_cast<std::size_t>(std::floor(path.duration() * lidar.rate_hz + 1e-9));
    for (int i = 0; i < options.people; ++i) {
      PathOptions walk;
      walk.speed_mps = options.people_speed_mps;
      walk.turn_rate_dps = 180.0;
      walk.acceleration_mps2 = 2.0;
      const std::uint64_t own = Random::derive(drive_seed, 100 + static_cast<std::uint64_t>(i));
      Random random(own);
      people.push_back({Path(world, walk, own), make_person(random)});
    }
  }

  /// People as they stand at a time. One who would stand on the robot has stepped aside.
  Shape people_at(double t) const {
    Shape shape;
    const Pose2 robot = path.pose_at(t);
    for (const Person& person : people) {
      const Pose2 pose = person.at(t);
      if (translation_distance(pose, robot) > kStepAside_m) shape.append(person.body, pose);
    }
    return shape;
  }
};

Drive::Drive(const World& world, const LidarOptions& lidar, Path path, const DriveOptions& options, std::uint64_t seed)
    : impl_(std::make_unique<Impl>(world, lidar, std::move(path), options, seed)) {}
Drive::~Drive() = default;
Drive::Drive(Drive&&) noexcept = default;

std::optional<DriveScan> Drive::next() {
  Impl& run = *impl_;
  if (run.done >= run.total) return {};
  const double period = 1.0 / run.lidar.rate_hz, start = static_cast<double>(run.done) * period;
  Random random(Random::derive(run.seed, 1'000'000 + run.done));
  const Shape people = run.people_at(start + 0.5 * period);
  DriveScan out;
  out.entry.scan = simulate_scan(
      {&run.caster, &people}, run.lidar, [&](double t) { return run.path.pose_at(start + t); }, start, random);
  out.T_world_laser = run.path.pose_at(start);
  out.twist = run.path.twist_at(start);
  if (run.options.odometry) out.entry.odometry = run.odometry.advance(out.T_world_laser, start);
  out.entry.laser = "laser";
  out.entry.line = static_cast<long>(++run.done);
  return out;
}

std::size_t Drive::size() const {
  return impl_->total;
}
const Path& Drive::path() const {
  return impl_->path;
}

}  // namespace phasescan::sim
