// Robots that are carried off in simulated buildings, with wheels that count wrong, seen through a localisation node
// without ROS. Prints a row for each world.
//
//   print_loopback [KIDNAPS [SENSOR [WORLD...]]]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "ros2/loopback.hpp"
#include "sim/pairs_spec.hpp"

namespace {

using namespace phasescan;
using namespace phasescan::ros2;

constexpr double kElsewhereM = 3.0, kWatched_s = 10.0, kFollowed_s = 6.0;

struct Row {
  std::vector<CarriedOff> carried;
  std::size_t scans = 0, within = 0;  ///< more than 10 s after it was carried off
};

/// A drive of its own from another place of the world.
std::optional<sim::Drive> drive_from_elsewhere(const MappedWorld& mapped, const sim::LidarOptions& lidar,
                                               const std::optional<Pose2>& last, std::uint64_t seed) {
  sim::PathOptions path;
  path.speed_mps = 0.5;
  sim::Drive drive(mapped.world, lidar, sim::Path(mapped.world, path, seed), {}, seed);
  const Pose2 first = mapped.T_map_world * drive.path().pose_at(0.0);
  if (!stands_on_map(mapped.map, first) || (last && translation_distance(first, *last) < kElsewhereM)) return {};
  return drive;
}

Row run(const MappedWorld& mapped, const sim::LidarOptions& lidar, std::size_t kidnaps) {
  Row row;
  LoopbackNode robot(to_grid(mapped.map, at(0), "map"));
  const double period_s = 1.0 / lidar.rate_hz;
  std::optional<Pose2> last;
  double t = 0.0;
  for (std::uint64_t seed = 1; row.carried.size() < kidnaps && seed < 20 * (kidnaps + 1); ++seed) {
    auto drive = drive_from_elsewhere(mapped, lidar, last, seed);
    if (!drive) continue;
    std::optional<CarryingWatch> watch;
    const double begun = t;
    bool first = true;
    while (auto scan = drive->next()) {
      const Pose2 truth = mapped.T_map_world * scan->T_world_laser;
      if (first && last) watch.emplace(translation_distance(*last, truth), period_s);
      const Pose2 step = first ? Pose2{} : last->inverse() * truth;
      scan->entry.scan.stamp = at(t += period_s);
      robot.add(ros::from_scan(scan->entry.scan, "laser", period_s), step);
      first = false, last = truth;
      const double error = robot.error_m(truth);
      if (watch && t - begun <= kWatched_s) watch->add(error, robot.node().status());
      if (t - begun > kWatched_s) row.scans += 1, row.within += error < 0.25;
      if (t - begun > kWatched_s + kFollowed_s) break;
    }
    if (watch) row.carried.push_back(watch->result());
  }
  return row;
}

/// Those that came within 3 s, all that came, their median and the longest.
std::string times(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  const auto soon = std::count_if(seconds.begin(), seconds.end(), [](double s) { return s <= 3.0; });
  if (seconds.empty()) return "0 | 0 | - | -";
  return fmt::format("{} | {} | {:.1f} | {:.1f}", soon, seconds.size(), seconds[seconds.size() / 2], seconds.back());
}

void print(const std::string& world, const Row& row) {
  std::vector<double> back, ok;
  double wrong_ok = 0.0;
  for (const CarriedOff& one : row.carried) {
    if (one.back_s) back.push_back(*one.back_s);
    if (one.ok_s) ok.push_back(*one.ok_s);
    wrong_ok = std::max(wrong_ok, one.wrong_ok_s);
  }
  fmt::print("| {} | {} | {} | {} | {:.1f} | {:.1f} |\n", world, row.carried.size(), times(back), times(ok), wrong_ok,
             100.0 * static_cast<double>(row.within) / static_cast<double>(std::max<std::size_t>(1, row.scans)));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t kidnaps = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 20;
  const std::string sensor = argc > 2 ? argv[2] : "rplidar-a1-real";
  std::vector<std::string> worlds(argv + std::min(argc, 3), argv + argc);
  if (worlds.empty()) worlds = {"flat:11", "office:12", "building:13"};
  const sim::LidarOptions lidar = sim::read_lidar(sensor);
  fmt::print(
      "| world, {} | carried off | within 0.25 m in 3 s | in {:.0f} s | median s | most s | and ok in 3 s | in {:.0f} s | "
      "median s | most s | longest s ok > 0.5 m off | within 0.25 m later % |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      sensor, kWatched_s, kWatched_s);
  for (const std::string& world : worlds) print(world, run(map_world(world, lidar, 1), lidar, kidnaps));
  return 0;
}
