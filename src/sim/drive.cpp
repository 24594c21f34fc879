#include "sim/drive.hpp"

#include <algorithm>
#include <cmath>

#include "sim/ray_caster.hpp"
#include "sim/furniture.hpp"
#include "sim/revolution.hpp"
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
  RevolutionSource source;
  std::vector<RevolutionTime> times;
  std::size_t turned = 0;  ///< revolutions so far, lost ones included
  std::size_t done = 0;

  Impl(const World& world, const LidarOptions& lidar_options, Path way, const DriveOptions& drive_options,
       std::uint64_t drive_seed)
      : caster(world.shape),
        lidar(lidar_options),
        path(std::move(way)),
        options(drive_options),
        seed(drive_seed),
        odometry({options.odometry_scale, options.odometry_noise, options.odometry_slip_per_min},
                 Random::derive(drive_seed, 1)),
        source(lidar, Random::derive(drive_seed, 2)) {
    check_lidar("sensor", lidar);
    validate_options("drive", options);
    times = plan_revolutions(lidar, path.duration(), Random::derive(drive_seed, 3));
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
  while (run.turned < run.times.size()) {
    const RevolutionTime time = run.times[run.turned];
    Random random(Random::derive(run.seed, 1'000'000 + run.turned++));
    DriveScan out;
    out.T_world_laser = run.path.pose_at(time.start_s);
    // Wheels turn and the sensor runs whether or not its scan arrives.
    if (run.options.odometry) out.entry.odometry = run.odometry.advance(out.T_world_laser, time.start_s);
    const Shape people = run.people_at(time.start_s + 0.5 * time.period_s);
    out.entry.scan = simulate_scan(
        {&run.caster, &people}, run.lidar, run.source, time.period_s,
        [&](double t) { return run.path.pose_at(time.start_s + t); }, time.start_s, random);
    if (time.lost) continue;
    out.twist = run.path.twist_at(time.start_s);
    out.entry.laser = "laser";
    out.entry.line = static_cast<long>(++run.done);
    return out;
  }
  return {};
}

std::size_t Drive::size() const {
  const auto& times = impl_->times;
  return static_cast<std::size_t>(std::count_if(times.begin(), times.end(), [](const auto& t) { return !t.lost; }));
}
const Path& Drive::path() const {
  return impl_->path;
}

}  // namespace phasescan::sim
