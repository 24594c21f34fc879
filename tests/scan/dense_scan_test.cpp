// Hits with empty beams between them, as converters of point clouds write them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "phasescan/scan/scan.hpp"
#include "scan/surface.hpp"

namespace phasescan::dense_scan_test {
namespace {

/// A square room of 4 m seen from off its middle, 600 hits a turn, `every` beams from one to the next.
Scan room(std::size_t every, bool jitter) {
  constexpr std::size_t kHits = 600;
  const std::size_t n = kHits * every;
  ScanGeometry geometry;
  geometry.angle_min = 0.001 - std::numbers::pi;
  geometry.angle_increment = 2.0 * std::numbers::pi / static_cast<double>(n);
  std::vector<float> ranges(n, 0.0F);
  for (std::size_t k = 0; k < kHits; ++k) {
    const std::size_t beam = k * every + (jitter ? (k * 7919) % every : 0);
    const double a = geometry.angle_min + static_cast<double>(beam) * geometry.angle_increment;
    const double x = std::cos(a) > 0 ? 2.3 / std::cos(a) : -1.7 / std::cos(a);
    const double y = std::sin(a) > 0 ? 1.8 / std::sin(a) : -2.2 / std::sin(a);
    // Noise of 5 mm that is the same for every spacing.
    const double noise = 0.005 * std::sin(12.9898 * static_cast<double>(k * k));
    ranges[beam] = static_cast<float>(std::min(x, y) + noise);
  }
  return make_scan(ranges, geometry);
}

SurfacePoints surface_of(const Scan& scan) {
  SurfaceWorkspace work;
  SurfacePoints points;
  find_surface(scan, {}, work, points, {});
  return points;
}

TEST(DenseScan, EmptyBeamsBetweenHitsChangeNothing) {
  const SurfacePoints plain = surface_of(room(1, false));
  for (const std::size_t every : {4u, 6u, 12u}) {
    const SurfacePoints spread = surface_of(room(every, false));
    ASSERT_EQ(spread.size(), plain.size());
    EXPECT_NEAR(spread.noise.floor_m, plain.noise.floor_m, 1e-3);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      ASSERT_EQ(spread[i].has_normal(), plain[i].has_normal()) << every << " " << i;
      ASSERT_NEAR(spread[i].nx, plain[i].nx, 0.02) << every << " " << i;
      ASSERT_NEAR(spread[i].length, plain[i].length, 0.02F * plain[i].length) << every << " " << i;
    }
  }
}

TEST(DenseScan, HitsAnywhereAmongEmptyBeamsHaveNormalsToo) {
  const SurfacePoints plain = surface_of(room(1, false));
  for (const std::size_t every : {4u, 6u}) {
    const SurfacePoints spread = surface_of(room(every, true));
    std::size_t with = 0;
    for (std::size_t i = 0; i < spread.size(); ++i) with += spread[i].has_normal();
    EXPECT_GT(with, 95 * spread.size() / 100) << every;
    EXPECT_LT(spread.noise.floor_m, 2.0F * plain.noise.floor_m) << every;
  }
}

}  // namespace
}  // namespace phasescan::dense_scan_test
