/// The map of the first moments: scans drawn where tracking saw them, until the first result of loops and graph enters.
#pragma once

#include <cstddef>

#include "map/occupancy_grid.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "phasescan/slam/result.hpp"

namespace phasescan::ros2 {

class FirstMap {
 public:
  explicit FirstMap(const OccupancyOptions& options) : grid_(options) {}

  /// Draws a scan that tracking matched, or with which it began. A robot that stands still is drawn no more than
  /// `kMostScans` times. @cost 0.2 ms
  void add(const RangeMeasurement& measurement, const ScanUpdate& update) {
    if (update.repeated || !is_tracked(update.status) || scans_ >= kMostScans) return;
    grid_.add_scan(measurement.scan, update.T_map_base() * measurement.T_base_laser);
    ++scans_;
  }
  bool empty() const { return scans_ == 0; }
  TrinaryMap draw() const { return make_trinary(grid_); }

  static constexpr std::size_t kMostScans = 1000;

 private:
  phasescan::OccupancyGrid grid_;
  std::size_t scans_ = 0;
};

}  // namespace phasescan::ros2
