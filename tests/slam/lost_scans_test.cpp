// Bursts of lost messages, as a slow computer or a weak link leaves them: the scan after one is found without a guess,
// or a new piece begins; no wrong map comes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "eval/trajectory_error.hpp"
#include "phasescan/slam/slam.hpp"
#include "sim/drive.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::lost_scans_test {
namespace {

struct Outcome {
  int pieces = 0;
  std::size_t off_map = 0, scans = 0;
  double largest_m = 0.0;  ///< error of a scan on the map
};

/// A drive in a flat whose sensor sees `fov_deg`; before each scan that is kept a burst is lost with a probability.
Outcome run_with_bursts(std::uint64_t seed, double fov_deg, int least, int most) {
  const sim::World world = sim::make_world(sim::WorldKind::kFlat, seed);
  sim::LidarOptions lidar;
  lidar.fov_deg = fov_deg;
  if (fov_deg < 360.0) lidar.angle_min_deg = -0.5 * fov_deg, lidar.clockwise = false;
  sim::PathOptions way;
  way.speed_mps = 0.4;
  sim::Drive drive(world, lidar, sim::Path(world, way, seed), {}, seed);
  std::mt19937_64 random(seed);
  std::bernoulli_distribution lost(0.05);
  std::uniform_int_distribution<int> length(least, most);
  Slam slam;
  std::vector<Pose2> truth;
  while (auto scan = drive.next()) {
    if (lost(random)) {
      for (int k = length(random); k > 0 && scan; --k) scan = drive.next();
    }
    if (!scan) break;
    truth.push_back(scan->T_world_laser);
    slam.add({scan->entry.scan});
  }
  const SlamResult result = slam.finish();
  Outcome out;
  out.pieces = result.pieces;
  out.scans = result.scans.size();
  AssociatedPoses poses;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    if (!result.scans[i].on_map) {
      ++out.off_map;
      continue;
    }
    poses.estimate.push_back(result.scans[i].T_map_base);
    poses.reference.push_back(truth[i]);
  }
  out.largest_m = error_stats(absolute_trajectory_errors(poses)).max;
  return out;
}

TEST(LostScans, BurstsOfAWholeViewChangeNothing) {
  for (const std::uint64_t seed : {51u, 52u, 53u}) {
    const Outcome out = run_with_bursts(seed, 360.0, 4, 16);
    EXPECT_EQ(out.pieces, 1) << seed;
    EXPECT_EQ(out.off_map, 0u) << seed;
    EXPECT_LT(out.largest_m, 0.15) << seed;
  }
}

TEST(LostScans, BurstsOfHalfAViewTearNoMap) {
  for (const std::uint64_t seed : {61u, 62u, 63u, 64u}) {
    const Outcome out = run_with_bursts(seed, 180.0, 3, 9);
    EXPECT_LT(static_cast<double>(out.off_map), 0.3 * static_cast<double>(out.scans)) << seed;
    EXPECT_LT(out.largest_m, 0.3) << seed;
  }
}

}  // namespace
}  // namespace phasescan::lost_scans_test
