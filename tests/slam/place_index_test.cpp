#include "phasescan/slam/place_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "phasescan/core/random.hpp"
#include "phasescan/scan/points.hpp"
#include "support/toy_world.hpp"

namespace phasescan {
namespace {

PlaceDescriptor random_descriptor(Random& random) {
  PlaceDescriptor d;
  for (auto& v : d) v = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
  return d;
}

std::uint32_t distance(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int step = int{a[i]} - int{b[i]};
    sum += static_cast<std::uint32_t>(step * step);
  }
  return sum;
}

TEST(PlaceIndex, AgreesWithBruteForce) {
  Random random(6);
  PlaceIndex index;
  std::vector<PlaceDescriptor> all;
  for (int i = 0; i < 1700; ++i) {
    all.push_back(random_descriptor(random));
    EXPECT_EQ(index.add(all.back()), static_cast<std::uint32_t>(i));
  }
  for (int q = 0; q < 20; ++q) {
    const PlaceDescriptor query = random_descriptor(random);
    for (const std::size_t limit : {std::size_t{0}, std::size_t{3}, std::size_t{700}}) {
      std::vector<PlaceHit> expected;
      for (std::size_t i = 0; i < (limit ? limit : all.size()); ++i)
        expected.push_back({static_cast<std::uint32_t>(i), distance(query, all[i])});
      std::stable_sort(expected.begin(), expected.end(),
                       [](const auto& a, const auto& b) { return a.distance < b.distance; });
      const auto found = index.nearest(query, 10, limit);
      ASSERT_EQ(found.size(), std::min<std::size_t>(10, expected.size()));
      for (std::size_t r = 0; r < found.size(); ++r) {
        EXPECT_EQ(found[r].place, expected[r].place);
        EXPECT_EQ(found[r].distance, expected[r].distance);
      }
    }
  }
  EXPECT_TRUE(index.nearest(all[0], 0).empty());
  EXPECT_TRUE(PlaceIndex().nearest(all[0], 5).empty());
}

TEST(PlaceDescriber, HardlyChangesWithAnyTurnAndMoreWithAnotherPlace) {
  const auto walls = testing::two_rooms();
  Random random(2);
  PlaceDescriber describer;
  ScanPoints points;
  const auto describe = [&](const Pose2& pose) {
    scan_to_points(testing::toy_scan(walls, pose, {}, random, 0), points);
    return describer.describe(points.x, points.y);
  };
  const PlaceDescriptor here = describe({0, 0, 0}), elsewhere = describe({6.5, -0.5, 0});
  for (const double turn : {0.3, 1.1, 2.0, 3.0, -2.2})
    EXPECT_LT(1.25 * distance(here, describe({0.05, 0.02, turn})), distance(here, elsewhere)) << turn;
  EXPECT_EQ(describer.describe({}, {}), PlaceDescriptor{});
}

TEST(PlaceDescriber, FinerSensorsSeeWhatCoarserOnesSee) {
  const auto walls = testing::two_rooms();
  PlaceDescriber describer;
  ScanPoints points;
  const auto describe = [&](const Pose2& pose, int beams) {
    Random random(2);
    testing::ToyLidar lidar;
    lidar.beams = beams;
    scan_to_points(testing::toy_scan(walls, pose, lidar, random, 0), points);
    return describer.describe(points.x, points.y);
  };
  const PlaceDescriptor here = describe({0, 0, 0}, 360);
  for (const int beams : {720, 1440})
    EXPECT_LT(1.5 * distance(here, describe({0, 0, 0.7}, beams)), distance(here, describe({6.5, -0.5, 0}, 360)));
}

}  // namespace
}  // namespace phasescan
