// The toy tour as a CARMEN log.
#pragma once

#include <fmt/format.h>

#include <sstream>
#include <string>
#include <vector>

#include "io/tum.hpp"
#include "support/toy_world.hpp"

namespace phasescan::testing {

struct ToyLog {
  std::string flaser;  ///< CARMEN text
  std::string truth;   ///< TUM text
  std::size_t scans = 0;
};

/// A tour through the toy world: the first `most` scans of a SICK, with the truth as odometry.
inline ToyLog toy_log(std::size_t most = 200) {
  const auto walls = two_rooms();
  const auto tour = toy_tour(0.2, 0.4, 1.0);
  Random random(77);
  ToyLidar lidar;
  lidar.beams = 360;
  lidar.field = kPi;
  lidar.range_max = 0.0;
  ToyLog log;
  std::vector<StampedPose> truth;
  for (std::size_t i = 0; i < std::min(most, tour.size()); ++i) {
    const Stamp stamp = stamp_from_seconds(1000.0 + 0.2 * static_cast<double>(i));
    const Scan scan = toy_scan(walls, tour[i], lidar, random, stamp);
    std::string line = "FLASER 360";
    for (const float r : scan.ranges) line += fmt::format(" {:.3f}", r);
    log.flaser += fmt::format("{} 0 0 0 {:.4f} {:.4f} {:.5f} {:.3f} host {:.3f}\n", line, tour[i].x, tour[i].y,
                              tour[i].theta, stamp_to_seconds(stamp), 0.2 * static_cast<double>(i));
    truth.push_back({stamp, tour[i]});
    ++log.scans;
  }
  log.truth = format_tum(truth);
  return log;
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line + "\n");
  return lines;
}

}  // namespace phasescan::testing
