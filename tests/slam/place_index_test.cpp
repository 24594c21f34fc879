#include "slam/place_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <limits>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"
#include "scan/points.hpp"
#include "support/toy_world.hpp"

namespace phasescan::place_index_test {
namespace {

PlaceDescriptor random_descriptor(Random& random) {
  PlaceDescriptor d;
  for (auto& v : d.numbers) v = static_cast<std::int8_t>(static_cast<int>(random.below(256)) - 128);
  for (auto& v : d.turning) v = static_cast<std::uint8_t>(random.below(256));
  return d;
}

std::uint32_t distance(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < a.numbers.size(); ++i) {
    const int step = int{a.numbers[i]} - int{b.numbers[i]};
    sum += static_cast<std::uint32_t>(step * step);
  }
  return sum;
}

int signed_nibble(int bits) {
  return (bits & 15) >= 8 ? (bits & 15) - 16 : bits & 15;
}

/// Re(sum_h exp(2 i h t) conj(a_h) b_h), for 64 turns t of half a turn as the index has them; the largest.
std::int32_t slow_likeness(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  std::int32_t best = std::numeric_limits<std::int32_t>::min();
  for (int t = 0; t < 64; ++t) {
    std::int32_t sum = 0;
    for (std::size_t k = 0; k < kTurningSize; ++k) {
      const int h = static_cast<int>(k / kTurningNumbers) + 1;
      const std::complex<int> z(signed_nibble(a.turning[k]), -signed_nibble(a.turning[k] >> 4)),
          w(signed_nibble(b.turning[k]), signed_nibble(b.turning[k] >> 4));
      const double angle = kTwoPi * (h * t % 64) / 64;
      const auto c = static_cast<int>(std::lround(127.0 * std::cos(angle))),
                 s = static_cast<int>(std::lround(127.0 * std::sin(angle)));
      sum += c * (z * w).real() - s * (z * w).imag();
    }
    best = std::max(best, sum);
  }
  return best;
}

PlaceDescriptor random_turning(Random& random) {
  PlaceDescriptor d;
  for (auto& v : d.turning) {
    const auto re = static_cast<int>(random.below(15)) - 7, im = static_cast<int>(random.below(15)) - 7;
    v = static_cast<std::uint8_t>((re & 15) | (im & 15) << 4);
  }
  return d;
}

/// Half of half a turn: harmonic h is multiplied by exp(-i h pi / 2), which 4 bits hold exactly.
PlaceDescriptor quarter_turned(const PlaceDescriptor& d) {
  PlaceDescriptor out = d;
  for (std::size_t k = 0; k < kTurningSize; ++k) {
    std::complex<int> z(signed_nibble(d.turning[k]), signed_nibble(d.turning[k] >> 4));
    for (std::size_t h = 0; h <= k / kTurningNumbers; ++h) z *= std::complex<int>(0, -1);
    out.turning[k] = static_cast<std::uint8_t>((z.real() & 15) | (z.imag() & 15) << 4);
  }
  return out;
}

TEST(TurnedLikeness, AgreesWithTheSumItStandsFor) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const PlaceDescriptor a = random_descriptor(random), b = random_descriptor(random);
    EXPECT_EQ(turned_likeness(a, b), slow_likeness(a, b));
  }
}

TEST(TurnedLikeness, IsTheSameAtAnyTurnAndEitherWayRound) {
  Random random(9);
  const PlaceDescriptor a = random_turning(random), b = random_turning(random);
  const PlaceDescriptor turned = quarter_turned(a);
  EXPECT_NE(a, turned);
  EXPECT_EQ(turned_likeness(a, turned), turned_likeness(a, a));
  EXPECT_EQ(turned_likeness(turned, b), turned_likeness(a, b));
  EXPECT_EQ(turned_likeness(a, b), turned_likeness(b, a));
  EXPECT_GT(turned_likeness(a, a), 3 * turned_likeness(a, b));
}

TEST(PlaceIndex, TellsApartWhatDiffersOnlyInHowItsHarmonicsAreTurned) {
  Random random(10);
  PlaceIndex index;
  const PlaceDescriptor query = random_turning(random);
  for (int i = 0; i < 30; ++i) index.add(i == 17 ? quarter_turned(query) : random_turning(random));
  EXPECT_EQ(index.nearest(query, 1)[0].place, 0U);  // they are all as near by the numbers that do not turn
  const auto found = index.most_alike(query, 3);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].place, 17U);
  EXPECT_GT(found[0].likeness, 2 * found[1].likeness);
  EXPECT_GE(found[1].likeness, found[2].likeness);
  EXPECT_EQ(index.most_alike(query, 3, 10).size(), 3U);
  EXPECT_EQ(index.most_alike(query, 50, 10).size(), 10U);
  EXPECT_TRUE(index.most_alike(query, 0).empty());
  EXPECT_TRUE(PlaceIndex().most_alike(query, 5).empty());
}

TEST(PlaceIndex, NumbersThatDoNotTurnCountAsWellAsThoseThatDo) {
  Random random(12);
  const PlaceDescriptor query = random_descriptor(random);
  PlaceDescriptor same_numbers = query, same_turning = query;
  same_numbers.turning[0] = 0;
  for (auto& v : same_turning.numbers) v = static_cast<std::int8_t>(-std::max<int>(v, -127));
  PlaceIndex index;
  index.add(same_turning);
  index.add(same_numbers);
  EXPECT_GT(turned_likeness(query, same_turning), turned_likeness(query, same_numbers));
  EXPECT_EQ(index.most_alike(query, 1)[0].place, 1U);
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
  for (const double turn : {0.3, 1.1, 2.0, 3.0, -2.2}) {
    const PlaceDescriptor turned = describe({0.05, 0.02, turn});
    EXPECT_GT(turned_likeness(here, turned), 1.25 * turned_likeness(elsewhere, turned)) << turn;
  }
}

TEST(PlaceDescriber, FeaturesTurnWithTheRobot) {
  const auto walls = testing::two_rooms();
  PlaceDescriber describer;
  ScanPoints points;
  const auto features = [&](double theta) {
    Random random(2);
    testing::ToyLidar lidar;
    lidar.noise = 0.0;
    scan_to_points(testing::toy_scan(walls, {0, 0, theta}, lidar, random, 0), points);
    PlaceFeatures out;
    EXPECT_TRUE(describer.features(points.x, points.y, out));
    return out;
  };
  const PlaceFeatures here = features(0.0);
  const double turn = deg_to_rad(50.0);
  const PlaceFeatures turned = features(turn);
  // Harmonic h of half a turn turns by 2 h times the heading; seen as if it did not, or the other way, little is left.
  const auto agreement = [&](double sign) {
    double sum = 0.0, power = 0.0;
    for (std::size_t f = 0; f < kPlaceFeatures; ++f) {
      const auto h = static_cast<double>(f % kPlaceHarmonics);
      if (h == 0.0) continue;
      const std::complex<double> a = here[f], b = turned[f];
      sum += (b * std::conj(a * std::polar(1.0, sign * 2.0 * h * turn))).real();
      power += std::norm(a);
    }
    return sum / power;
  };
  EXPECT_GT(agreement(-1.0), 0.8);
  EXPECT_LT(agreement(0.0), 0.5);
  EXPECT_LT(agreement(1.0), 0.5);
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
}  // namespace phasescan::place_index_test
