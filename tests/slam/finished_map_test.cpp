// What a finished run says and draws.
#include <gtest/gtest.h>

#include <algorithm>

#include "map/glass.hpp"
#include "phasescan/slam/slam.hpp"
#include "sim/lidar.hpp"

namespace phasescan::finished_map_test {
namespace {

/// A round past a pane of 2 m in the wall between two rooms, with an RPLidar A1.
SlamResult past_a_pane(const SlamOptions& options) {
  sim::Shape shape;
  shape.add_line({{4, 0}, {0, 0}, {0, 5}, {4, 5}});
  shape.add_line({{4, 0}, {8, 0}, {8, 5}, {4, 5}});
  shape.add_line({{4, 0}, {4, 1}});
  shape.add_line({{4, 3}, {4, 5}});
  shape.add_box({0.3, 2.0}, 0.5, 1.2);
  shape.add_line({{4, 1}, {4, 3}}, sim::Material::kGlass);
  const sim::RayCaster caster(shape);
  Random random(11);
  Slam slam(options);
  const std::vector<Eigen::Vector2d> stops = {{1.2, 0.6}, {3.0, 0.7}, {2.8, 3.8}, {1.3, 3.8}, {1.2, 0.6}};
  for (std::size_t s = 1; s < stops.size(); ++s) {
    const Eigen::Vector2d way = stops[s] - stops[s - 1];
    for (double along = 0.0; along < way.norm(); along += 0.1) {
      const Eigen::Vector2d at = stops[s - 1] + way.normalized() * along;
      Scan scan = sim::simulate_scan({&caster, nullptr}, {}, {at.x(), at.y(), 0.0}, random);
      scan.stamp = stamp_from_seconds(1.0 + 0.2 * static_cast<double>(slam.scans()));
      slam.add({scan});
    }
  }
  return slam.finish();
}

TEST(FinishedMap, PanesAreOccupiedWhereTheyAreSureAlone) {
  SlamOptions open;
  open.glass.block = false;
  const std::vector<CellState> as_seen = past_a_pane(open).map.cells;
  for (const int min_views : {SlamOptions().glass.min_views, 1000}) {
    SlamOptions options;
    options.glass.min_views = min_views;  // of 1000 views no pane here is sure
    const SlamResult result = past_a_pane(options);
    ASSERT_FALSE(result.glass.empty());
    const bool sure = std::any_of(result.glass.begin(), result.glass.end(), [](const GlassPane& p) { return p.sure; });
    EXPECT_EQ(sure, min_views < 1000);
    EXPECT_EQ(result.map.cells != as_seen, sure);
  }
}

}  // namespace
}  // namespace phasescan::finished_map_test
