// The same building later.
#include "sim/rearrange.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/world_kinds.hpp"

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// Corners of a world that are corners of another too.
double share_kept(const World& before, const World& after) {
  std::size_t kept = 0;
  for (const Segment& s : before.shape.segments)
    kept += std::any_of(after.shape.segments.begin(), after.shape.segments.end(),
                        [&](const Segment& t) { return s.a == t.a && s.b == t.b; });
  return static_cast<double>(kept) / static_cast<double>(before.shape.segments.size());
}

TEST(Rearrange, NothingChangesWhereNothingShall) {
  const World world = make_world(WorldKind::kFlat, 4);
  const World same = rearrange(world, {0.0, 0.0}, 1);
  EXPECT_EQ(share_kept(world, same), 1.0);
  EXPECT_EQ(same.shape.segments.size(), world.shape.segments.size());
  EXPECT_EQ(same.shape.discs.size(), world.shape.discs.size());
  EXPECT_EQ(same.doors.size(), world.doors.size());
}

TEST(Rearrange, MovesAShareOfTheFurnitureWithinItsRoomAndLeavesWalls) {
  const World world = make_world(WorldKind::kOffice, 9);
  std::size_t in_parts = 0;
  for (const MovablePart& part : world.parts) in_parts += part.last_segment - part.first_segment;
  const double of_parts = static_cast<double>(in_parts) / static_cast<double>(world.shape.segments.size());
  EXPECT_GT(of_parts, 0.3);
  EXPECT_LT(of_parts, 0.98);
  const World all = rearrange(world, {1.0, 1.0}, 2), some = rearrange(world, {0.3, 0.3}, 2);
  EXPECT_NEAR(share_kept(world, all), 1.0 - of_parts, 1e-9);  // walls alone stay
  EXPECT_NEAR(share_kept(world, some), 1.0 - 0.3 * of_parts, 0.12);
  EXPECT_GT(all.shape.segments.size(), world.shape.segments.size() / 2);  // most is moved, not gone
  // What was moved stands in the same room, clear of doorways.
  std::size_t outside = 0;
  for (const Disc& disc : all.shape.discs) {
    outside += std::none_of(world.rooms.begin(), world.rooms.end(),
                            [&](const Polygon& room) { return inside_polygon(room, disc.center); });
  }
  EXPECT_LT(outside, all.shape.discs.size() / 10);
}

TEST(Rearrange, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const World world = make_world(WorldKind::kFlat, 5);
  const World a = rearrange(world, {}, 3), b = rearrange(world, {}, 3), c = rearrange(world, {}, 4);
  EXPECT_EQ(share_kept(a, b), 1.0);
  EXPECT_LT(share_kept(a, c), 1.0);
}

TEST(Rearrange, ShutsDoorways) {
  const World world = make_world(WorldKind::kBuilding, 3);
  const World later = rearrange(world, {0.0, 1.0}, 5);
  EXPECT_LT(later.doors.size(), world.doors.size());
  EXPECT_GT(later.doors.size(), world.doors.size() / 3);
}

}  // namespace
}  // namespace phasescan::sim
