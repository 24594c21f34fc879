// phasescan bench steps: what a scan costs the caller where loops and graph run beside it and are never waited for.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <vector>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/slam/slam.hpp"
#include "sim/drive.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/world_file.hpp"

namespace phasescan::app {
namespace {

struct StepsFlags {
  CommonFlags common;
  std::size_t scans = 17'480;
  double speed_mps = 0.6;
  std::string world = "building:1", sensor = "rplidar-a1";
};

/// Milliseconds at a share of the sorted steps.
double at(const std::vector<double>& sorted_s, double share) {
  return 1e3 * sorted_s[static_cast<std::size_t>(share * static_cast<double>(sorted_s.size() - 1))];
}

int run_steps(const StepsFlags& flags) {
  const sim::World world = sim::world_by_name(flags.world, flags.common.seed);
  const sim::LidarOptions lidar = sim::read_lidar(flags.sensor);
  sim::PathOptions path;
  path.speed_mps = flags.speed_mps;
  path.duration_s = static_cast<double>(flags.scans) / lidar.rate_hz;
  sim::Drive drive(world, lidar, sim::Path(world, path, Random::derive(flags.common.seed, 1)), {},
                   Random::derive(flags.common.seed, 2));
  ThreadExecutor executor;
  Slam slam(config_from(flags.common).slam, Schedule::kLatest, &executor);
  Progress progress("scans", flags.scans);
  const InterruptGuard guard;
  std::vector<double> steps_s;
  double way_m = 0.0, largest_off_m = 0.0;
  Pose2 T_world_start, last;
  while (!InterruptGuard::interrupted() && steps_s.size() < flags.scans) {
    const auto scan = drive.next();
    if (!scan) break;
    if (steps_s.empty()) T_world_start = last = scan->T_world_laser;
    way_m += translation_distance(last, scan->T_world_laser);
    last = scan->T_world_laser;
    const double before = thread_cpu_seconds();
    const ScanUpdate update = slam.add({scan->entry.scan});
    steps_s.push_back(thread_cpu_seconds() - before);
    largest_off_m = std::max(largest_off_m, translation_distance(update.T_map_base(), T_world_start.inverse() * last));
    progress.step(steps_s.size());
  }
  if (steps_s.empty()) return stopped_with_nothing();
  std::sort(steps_s.begin(), steps_s.end());
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  print(fmt::format(
      "{{\"scans\": {}, \"way_m\": {:.0f}, \"keyframes\": {}, \"add_cpu_ms\": {{\"p50\": {:.3f}, \"p99\": {:.3f}, "
      "\"max\": {:.3f}}}, \"largest_off_m\": {:.3f}, \"peak_memory_mib\": {:.0f}}}\n",
      steps_s.size(), way_m, slam.map()->keyframes().size(), at(steps_s, 0.5), at(steps_s, 0.99), at(steps_s, 1.0),
      largest_off_m, static_cast<double>(usage.ru_maxrss) / 1024.0));
  return kDone;
}

}  // namespace

void add_steps_command(CLI::App& app, CommandBody& body) {
  auto* command = app.get_subcommand("bench")->add_subcommand(
      "steps",
      "CPU time of the caller for each scan of a long simulated drive, with loops and graph beside it (latest)");
  auto flags = std::make_shared<StepsFlags>();
  command->add_option("--scans", flags->scans, "length of the drive")
      ->type_name("N")
      ->check(CLI::Range(100, 100'000'000))
      ->capture_default_str();
  command->add_option("--speed", flags->speed_mps, "of the robot [m/s]")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--world", flags->world, "as for simulate")->capture_default_str();
  command->add_option("--sensor", flags->sensor, "as for simulate")->capture_default_str();
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench steps --scans 2000");
  command->callback([flags, &body] { body = [flags] { return run_steps(*flags); }; });
}

}  // namespace phasescan::app
