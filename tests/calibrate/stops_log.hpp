// Logs of a simulated robot that stands at one place after another.
#pragma once

#include <vector>

#include "calibrate/calibrate.hpp"
#include "phasescan/io/log.hpp"
#include "sim/placement.hpp"
#include "sim/drive.hpp"
#include "sim/revolution.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::test {

struct StopsLog {
  sim::WorldKind world = sim::WorldKind::kFlat;
  int stops = 25;
  int scans = 20;  ///< a stop
  std::uint64_t seed = 1;
  bool wheels = true;
};

/// The robot is carried from stop to stop in no time; revolutions and their faults go on.
inline std::vector<LogEntry> stops_log(const sim::LidarOptions& lidar, const StopsLog& log = {}) {
  const sim::World world = sim::make_world(log.world, log.seed);
  const sim::RayCaster caster(world.shape);
  sim::RevolutionSource source(lidar, Random::derive(log.seed, 1));
  const double duration = 1.02 * log.stops * log.scans / lidar.rate_hz / (1.0 - 0.9 * lidar.effects.lost_revolutions);
  const auto times = sim::plan_revolutions(lidar, duration, Random::derive(log.seed, 2));
  std::vector<LogEntry> entries;
  Pose2 pose;
  int left = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    Random random(Random::derive(log.seed, 1000 + k));
    if (left == 0) {
      pose = sim::draw_pose(world, caster, 0.3, random).value_or(pose);
      left = log.scans;
    }
    const Scan scan = sim::simulate_scan(
        {&caster, nullptr}, lidar, source, times[k].period_s, [&](double) { return pose; }, times[k].start_s, random);
    if (times[k].lost) continue;
    --left;
    LogEntry entry;
    entry.scan = scan;
    entry.laser = "laser";
    if (log.wheels) entry.odometry = pose;
    entries.push_back(entry);
  }
  return entries;
}

inline std::optional<Calibration> calibrate(const std::vector<LogEntry>& entries) {
  Calibrator calibrator;
  for (const LogEntry& entry : entries) calibrator.add(entry);
  return calibrator.finish();
}

/// A sensor with nothing but what a test switches on.
inline sim::LidarOptions plain_lidar() {
  sim::LidarOptions lidar;
  lidar.sigma_m = 0.003;
  lidar.sigma_relative = 0.0;
  lidar.dropout = 0.0;
  lidar.mixed_pixels = 0.0;
  lidar.resolution_m = 0.0;
  lidar.grazing_deg = 90.0;
  return lidar;
}

}  // namespace phasescan::test
