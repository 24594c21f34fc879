// Glass and black surfaces as whole runs find them: furnished buildings, no odometry, no truth.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/drive.hpp"
#include "sim/world_kinds.hpp"
#include "phasescan/slam/slam.hpp"

namespace phasescan::glass_slam_test {
namespace {

struct Claims {
  double right_m = 0.0, wrong_m = 0.0, door_m = 0.0;  ///< of sure panes
};

/// A tour with an RPLidar A1; the map's frame is that of the first scan.
Claims tour(sim::WorldKind kind, std::uint64_t seed) {
  const sim::World world = sim::make_world(kind, seed);
  sim::PathOptions way;
  way.duration_s = 240.0;
  sim::Drive drive(world, {}, sim::Path(world, way, seed), {}, seed);
  Slam slam;
  Pose2 T_world_map;
  while (const auto scan = drive.next()) {
    if (slam.scans() == 0) T_world_map = scan->T_world_laser;
    slam.add({scan->entry.scan});
  }
  const SlamResult result = slam.finish();
  Claims claims;
  for (const GlassPane& pane : result.glass) {
    if (!pane.sure) continue;
    constexpr int kSteps = 20;
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector2d p = T_world_map * Eigen::Vector2d(pane.a + (pane.b - pane.a) * k / kSteps);
      double hidden = 1e9;
      for (const sim::Segment& s : world.shape.segments)
        if (s.material != sim::Material::kMatt) hidden = std::min(hidden, sim::point_segment_distance(p, s.a, s.b));
      (hidden < 0.25 ? claims.right_m : claims.wrong_m) += pane.length() / (kSteps + 1);
      for (const sim::Doorway& door : world.doors) {
        const bool inside = std::min((p - door.a).norm(), (p - door.b).norm()) > 0.2;
        if (inside && hidden > 0.25 && sim::point_segment_distance(p, door.a, door.b) < 0.15)
          claims.door_m += pane.length() / (kSteps + 1);
      }
    }
  }
  return claims;
}

TEST(GlassSlam, FurnishedBuildingsHaveFewWrongClaimsAndNoClaimedDoor) {
  Claims all;
  for (const sim::WorldKind kind : {sim::WorldKind::kFlat, sim::WorldKind::kOffice}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Claims claims = tour(kind, seed);
      all.right_m += claims.right_m;
      all.wrong_m += claims.wrong_m;
      all.door_m += claims.door_m;
    }
  }
  EXPECT_EQ(all.door_m, 0.0);
  EXPECT_GT(all.right_m, 8.0);
  EXPECT_LT(all.wrong_m, 0.2 * all.right_m);
}

}  // namespace
}  // namespace phasescan::glass_slam_test
