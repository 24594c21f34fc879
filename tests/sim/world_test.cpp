#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "phasescan/io/error.hpp"
#include "sim/places.hpp"
#include "sim/ray_caster.hpp"
#include "sim/world_file.hpp"
#include "sim/furniture.hpp"

namespace phasescan::sim::world_test {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

TEST(Worlds, AreTheSameForTheSameSeedAndOthersForOthers) {
  for (std::size_t kind = 0; kind < enum_names<WorldKind>().size(); ++kind) {
    const World a = make_world(static_cast<WorldKind>(kind), 5), b = make_world(static_cast<WorldKind>(kind), 5);
    const World c = make_world(static_cast<WorldKind>(kind), 6);
    ASSERT_EQ(a.shape.segments.size(), b.shape.segments.size());
    for (std::size_t i = 0; i < a.shape.segments.size(); ++i) EXPECT_EQ(a.shape.segments[i].a, b.shape.segments[i].a);
    EXPECT_NE(a.shape.segments[0].b, c.shape.segments[0].b);
    EXPECT_FALSE(a.rooms.empty());
  }
}

TEST(Worlds, HaveWallsAllAround) {
  // From inside a room no ray leaves the building but through a glass door.
  Random random(3);
  for (const WorldKind kind :
       {WorldKind::kRoom, WorldKind::kOffice, WorldKind::kCorridor, WorldKind::kFlat, WorldKind::kBuilding}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const World world = make_world(kind, seed);
      const RayCaster caster(world.shape);
      for (const Polygon& room : world.rooms) {
        const Vector2d middle = 0.25 * (room[0] + room[1] + room[2] + room[3]);
        for (int i = 0; i < 50; ++i) {
          const double angle = random.uniform(-kPi, kPi);
          EXPECT_TRUE(caster.cast(middle, {std::cos(angle), std::sin(angle)}, 200.0).found()) << world.name;
        }
      }
    }
  }
}

TEST(Worlds, BuildingsHaveTwentyRoomsAndMore) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::size_t rooms = make_world(WorldKind::kBuilding, seed).rooms.size();
    EXPECT_GE(rooms, 20U);
    EXPECT_LE(rooms, 110U);
  }
}

TEST(Worlds, EmptyRoomsLookTheSameAfterHalfATurn) {
  const World world = make_world(WorldKind::kEmptyRoom, 4);
  const RayCaster caster(world.shape);
  const Vector2d p(0.4, -0.3);
  for (int i = 0; i < 90; ++i) {
    const Vector2d direction(std::cos(0.1 * i), std::sin(0.1 * i));
    EXPECT_NEAR(caster.cast(p, direction, 50.0).range, caster.cast(-p, -direction, 50.0).range, 1e-9);
  }
}

TEST(Furniture, FitsItsFootprintAndFootprintsTellOverlap) {
  Random random(2);
  for (int kind = 0; kind <= static_cast<int>(ItemKind::kRack); ++kind) {
    for (int k = 0; k < 50; ++k) {
      const Item item = make_item(static_cast<ItemKind>(kind), random);
      constexpr double kPlay_m = 0.08;
      for (const Segment& s : item.shape.segments) {
        EXPECT_LE(std::abs(s.a.x()), 0.5 * item.width + kPlay_m) << kind;
        EXPECT_LE(std::abs(s.a.y()), 0.5 * item.depth + kPlay_m) << kind;
      }
    }
  }
  const Footprint a{{0.0, 0.0, 0.0}, 2.0, 1.0};
  EXPECT_TRUE(footprints_overlap(a, {{1.2, 0.0, 0.5}, 1.0, 0.2}, 0.0));
  EXPECT_FALSE(footprints_overlap(a, {{1.6, 0.0, 0.5 * kPi}, 1.0, 0.2}, 0.0));
  EXPECT_TRUE(footprints_overlap(a, {{1.15, 0.0, 0.5 * kPi}, 1.0, 0.2}, 0.1));
}

TEST(WorldFile, IsReadAndItsMistakesNameTheLine) {
  const World world = parse_world(
      "name: den\nwalls:\n  - {points: [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]}\n"
      "  - {points: [[1, 1], [2, 1], [2, 2]], closed: true, material: black}\ndiscs:\n  - {center: [3, 2], radius: "
      "0.2}\n",
      "den.yaml");
  EXPECT_EQ(world.name, "den");
  EXPECT_EQ(world.shape.segments.size(), 7U);
  EXPECT_EQ(world.shape.solids.size(), 1U);
  EXPECT_EQ(world.shape.segments[5].material, Material::kBlack);
  ASSERT_EQ(world.rooms.size(), 1U);
  EXPECT_EQ(world.rooms[0][2], Vector2d(4.0, 3.0));
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_world(text, "w.yaml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("walls:\n  - {points: [[0, 0], [a, 1]]}\n"), HasSubstr("w.yaml:2: expected a point"));
  EXPECT_THAT(message("walls:\n  - {points: [[0, 0]]}\n"), HasSubstr("w.yaml:2: expected 2 or more points"));
  EXPECT_THAT(message("walls:\n  - {points: [[0, 0], [1, 1]], colour: red}\n"),
              HasSubstr("w.yaml:2: unknown key 'colour'"));
  EXPECT_THAT(message("walls:\n  - {closed: true}\n"), HasSubstr("w.yaml:2: points: missing"));
  EXPECT_THAT(message("walls:\n  - {points: [[0, 0], [1, .nan]]}\n"), HasSubstr("expected a point"));
  EXPECT_THAT(message("discs:\n  - {center: [0, 0], radius: -1}\n"), HasSubstr("w.yaml:2: radius"));
  EXPECT_THAT(message(""), HasSubstr("expected a map"));
  EXPECT_THAT(message("rooms: []\n"), HasSubstr("walls: none given"));
}

TEST(WorldFile, KindsGoBeforeFilesAndCanNameABuilding) {
  EXPECT_EQ(world_by_name("flat:7", 1).name, "flat-7");
  EXPECT_EQ(world_by_name("apartment", 3).name, "flat-3");
  EXPECT_THROW(world_by_name("flat:x", 1), InputError);
  EXPECT_THROW(world_by_name("no-such-world.yaml", 1), InputError);
}

TEST(Places, AreApartAndEachHasAQueryInSight) {
  const LidarOptions lidar;
  const PlacesOptions options;
  const auto places = make_places(options, lidar, 4, 2), again = make_places(options, lidar, 4, 2);
  ASSERT_GT(places.size(), 8U);
  ASSERT_EQ(places.size(), again.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(places[i].T_world_query.theta, again[i].T_world_query.theta);
    EXPECT_LE(translation_distance(places[i].T_world_place, places[i].T_world_query), options.reach_m);
    EXPECT_EQ(places[i].scan.size(), 360U);
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GE(translation_distance(places[i].T_world_place, places[k].T_world_place), options.apart_m);
    const auto& right = places[i].in_reach;
    EXPECT_TRUE(std::is_sorted(right.begin(), right.end()));
    EXPECT_TRUE(std::find(right.begin(), right.end(), i) != right.end());
    for (const std::uint32_t k : right)
      EXPECT_LE(translation_distance(places[k].T_world_place, places[i].T_world_query), options.reach_m);
  }
}

}  // namespace
}  // namespace phasescan::sim::world_test
