#include "slam_mcap.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "io/even_scan.hpp"

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

void SlamRecording::add(const LogEntry& entry) {
  if (!start_) start_ = entry.scan.stamp;
  const auto [laser, is_new] = names_.of(entry.laser);
  if (is_new) file_.static_transform(*start_, "base_link", laser.frame, entry.T_base_laser, entry.flipped);
  file_.scan(laser.topic, laser.frame, even_scan(entry.scan));
}

void SlamRecording::finish(const SlamResult& result) {
  const Stamp start = start_.value_or(0);
  std::vector<std::pair<Stamp, Pose2>> poses;
  poses.reserve(result.scans.size());
  for (const ScanResult& scan : result.scans) poses.emplace_back(scan.stamp, scan.T_map_base);
  file_.path("/path", start, "map", poses);
  write_map(file_, start, result.map);
  for (const ScanResult& scan : result.scans) {
    file_.transform(scan.stamp, "map", "odom", scan.T_map_base * scan.T_odom_base.inverse());
    file_.transform(scan.stamp, "odom", "base_link", scan.T_odom_base);
  }
  file_.close();
}

}  // namespace phasescan::app
