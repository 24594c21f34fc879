#include "sim/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"
#include "sim/world_kinds.hpp"

namespace phasescan::sim::ray_caster_test {
namespace {

using Eigen::Vector2d;

TEST(RayCaster, AgreesWithLookingAtEverySurface) {
  Random random(7);
  for (const WorldKind kind : {WorldKind::kRoom, WorldKind::kOffice, WorldKind::kCorridor, WorldKind::kFlat,
                               WorldKind::kHall, WorldKind::kEmptyRoom, WorldKind::kBareCorridor}) {
    const World world = make_world(kind, random.bits());
    const RayCaster caster(world.shape);
    for (int i = 0; i < 1500; ++i) {
      const Vector2d origin(random.uniform(-3.0, 25.0), random.uniform(-8.0, 15.0));
      // Axis-parallel rays are where a grid walk goes wrong first.
      const double angle = i % 3 ? random.uniform(-kPi, kPi) : 0.5 * kPi * static_cast<double>(random.below(4));
      const Vector2d direction(std::cos(angle), std::sin(angle));
      const double far = random.uniform(0.5, 30.0), near = i % 5 ? 0.0 : random.uniform(0.0, 3.0);
      const RayHit expected = cast_all(world.shape, origin, direction, far, near),
                   hit = caster.cast(origin, direction, far, near);
      ASSERT_EQ(hit.found(), expected.found()) << world.name << " " << origin.transpose() << " " << angle;
      if (!hit.found()) continue;
      EXPECT_EQ(hit.range, expected.range) << world.name;
      EXPECT_NEAR(hit.normal.norm(), 1.0, 1e-12);
      EXPECT_NEAR(hit.cos_incidence, -hit.normal.dot(direction), 1e-12);
      EXPECT_GE(hit.cos_incidence, 0.0);
    }
  }
}

TEST(RayCaster, ClearanceAgreesWithLookingAtEverySurface) {
  Random random(8);
  const World world = make_world(WorldKind::kFlat, 3);
  const RayCaster caster(world.shape);
  for (int i = 0; i < 500; ++i) {
    const Vector2d p(random.uniform(-1.0, 12.0), random.uniform(-1.0, 9.0));
    EXPECT_NEAR(caster.clearance(p, 0.4), std::min(0.4, world.shape.clearance(p)), 1e-12);
  }
}

TEST(RayCaster, AnEmptyWorldStopsNothing) {
  const RayCaster caster{Shape{}};
  EXPECT_FALSE(caster.cast({0.0, 0.0}, {1.0, 0.0}, 100.0).found());
  EXPECT_TRUE(caster.line_of_sight({0.0, 0.0}, {5.0, 5.0}));
}

TEST(RayCaster, DiscsAreMetOnTheNearSide) {
  Shape shape;
  shape.add_disc({3.0, 0.0}, 1.0);
  const RayHit hit = RayCaster(shape).cast({0.0, 0.0}, {1.0, 0.0}, 10.0);
  EXPECT_DOUBLE_EQ(hit.range, 2.0);
  EXPECT_NEAR(hit.cos_incidence, 1.0, 1e-12);
}

}  // namespace
}  // namespace phasescan::sim::ray_caster_test
