#include "slam_mcap.hpp"

#include <algorithm>
#include <vector>

#include "io/even_scan.hpp"
#include "io/laser_names.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "slam_output.hpp"

namespace phasescan::app {
namespace {

void write_map(McapWriter& file, Stamp stamp, const TrinaryMap& map) {
  std::vector<std::int8_t> cells(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), cells.begin(),
                 [](CellState state) { return static_cast<std::int8_t>(state); });
  file.grid("/map", stamp, "map",
            {map.resolution_m, static_cast<std::uint32_t>(map.width), static_cast<std::uint32_t>(map.height),
             map.origin, cells});
}

}  // namespace

void write_slam_mcap(McapWriter& file, const std::string& log, const LogOptions& options, const Slam& slam,
                     bool glass_blocks) {
  const std::vector<Pose2> trajectory = slam.trajectory();
  const std::vector<Pose2> odometry = slam.odometry_trajectory();
  const Stamp start = slam.records().front().stamp;
  std::vector<std::pair<Stamp, Pose2>> poses;
  poses.reserve(trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) poses.emplace_back(slam.records()[i].stamp, trajectory[i]);
  file.path("/path", start, "map", poses);
  write_map(file, start, finished_map(slam, glass_blocks).map);
  LaserNames names;
  const auto reader = open_log(log, options);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const std::optional<LogEntry> entry = reader->next();
    if (!entry) break;
    const auto [laser, is_new] = names.of(entry->laser);
    if (is_new) file.static_transform(start, "base_link", laser.frame, entry->T_base_laser, entry->flipped);
    const Pose2& T_odom_base = odometry[i];
    file.transform(poses[i].first, "map", "odom", trajectory[i] * T_odom_base.inverse());
    file.transform(poses[i].first, "odom", "base_link", T_odom_base);
    file.scan(laser.topic, laser.frame, even_scan(entry->scan));
  }
  file.close();
}

}  // namespace phasescan::app
