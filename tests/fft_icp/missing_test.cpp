#include "fft_icp/missing/missing.hpp"

#include <gtest/gtest.h>

#include "phasescan/core/pose2.hpp"

namespace phasescan::missing_test {
namespace {

/// A scan of one beam per degree from -180 deg in which the given sectors [deg] are missing.
Scan scan_with_gaps(std::initializer_list<std::pair<int, int>> sectors, bool clockwise = false, int beams = 360,
                    double fov_deg = 360) {
  std::vector<float> ranges(static_cast<std::size_t>(beams), 2.0F);
  const double step = fov_deg / beams, from = -fov_deg / 2;
  for (int i = 0; i < beams; ++i) {
    const double angle = clockwise ? -from - i * step : from + i * step;
    for (const auto& [a, b] : sectors) {
      for (const double turn : {-360.0, 0.0, 360.0}) {
        if (angle + turn >= a && angle + turn < b) ranges[static_cast<std::size_t>(i)] = 0.0F;
      }
    }
  }
  return make_scan(ranges, {deg_to_rad(clockwise ? -from : from), deg_to_rad(clockwise ? -step : step), 0.1, 6.0});
}

MissingFeatures features(const Scan& scan, double dmax = 0.0, double least_deg = 8.0) {
  MissingFinder finder;
  MissingFeatures out;
  finder.find(scan, dmax, deg_to_rad(least_deg), out);
  return out;
}

TEST(Missing, RunsHaveCentreAndWidthAndNarrowOnesAreDropped) {
  const MissingFeatures f = features(scan_with_gaps({{20, 50}, {100, 105}, {-90, -70}}));
  ASSERT_EQ(f.runs.size(), 2U);
  EXPECT_NEAR(rad_to_deg(f.runs[0].centre()), -80.5, 1e-6);
  EXPECT_NEAR(rad_to_deg(f.runs[1].centre()), 34.5, 1e-6);
  EXPECT_NEAR(rad_to_deg(f.runs[1].width), 30.0, 1e-6);
  EXPECT_NEAR(rad_to_deg(f.size), 50.0, 1e-6);
  EXPECT_TRUE(f.full_turn);
}

TEST(Missing, ARunAcrossTheSeamIsOneRun) {
  const MissingFeatures f = features(scan_with_gaps({{165, 200}}));
  ASSERT_EQ(f.runs.size(), 1U);
  EXPECT_NEAR(rad_to_deg(f.runs[0].width), 35.0, 1e-6);
  EXPECT_NEAR(angle_distance(f.runs[0].centre(), deg_to_rad(182.0)), 0.0, deg_to_rad(0.51));
}

TEST(Missing, AClockwiseSensorSeesTheSameRuns) {
  const MissingFeatures a = features(scan_with_gaps({{20, 50}, {170, 200}}));
  const MissingFeatures b = features(scan_with_gaps({{20, 50}, {170, 200}}, true));
  ASSERT_EQ(a.runs.size(), 2U);
  ASSERT_EQ(b.runs.size(), 2U);
  EXPECT_NEAR(a.size, b.size, deg_to_rad(1.1));
  for (const MissingRun& run : a.runs) {
    EXPECT_TRUE(std::any_of(b.runs.begin(), b.runs.end(), [&](const MissingRun& other) {
      return angle_distance(run.centre(), other.centre()) < deg_to_rad(1.1);
    }));
  }
}

TEST(Missing, AnglesOfTheirOwnInAnyOrderGiveTheSameRuns) {
  const Scan scan = scan_with_gaps({{20, 50}, {165, 200}});
  std::vector<float> ranges, angles;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const std::size_t k = (i * 7) % scan.size();  // 7 and 360 share no divisor
    ranges.push_back(raw_range(scan, k));
    angles.push_back(static_cast<float>(scan.angle(k)));
  }
  const MissingFeatures expected = features(scan), got = features(make_scan(ranges, {0.0, 0.0, 0.1, 6.0}, angles));
  ASSERT_EQ(got.runs.size(), expected.runs.size());
  EXPECT_NEAR(got.size, expected.size, 1e-4);
  EXPECT_TRUE(got.full_turn);
}

TEST(Missing, OutsideOfTheFieldOfViewIsNoRun) {
  const MissingFeatures f = features(scan_with_gaps({{-90, -60}, {70, 90}}, false, 180, 180));
  EXPECT_FALSE(f.full_turn);
  ASSERT_EQ(f.runs.size(), 2U);  // not joined behind the sensor
  EXPECT_NEAR(rad_to_deg(f.size), 50.0, 1e-6);
}

TEST(Missing, AReturnBeyondDmaxIsMissing) {
  EXPECT_EQ(features(scan_with_gaps({}), 3.0).runs.size(), 0U);
  const MissingFeatures f = features(scan_with_gaps({}), 1.5);
  ASSERT_EQ(f.runs.size(), 1U);
  EXPECT_DOUBLE_EQ(f.size, kTwoPi);
}

TEST(Missing, MoreThanATurnCountsOnce) {
  std::vector<float> ranges(400, 2.0F);
  for (std::size_t i = 100; i < 130; ++i) ranges[i] = 0.0F;
  const MissingFeatures f = features(make_scan(ranges, {-kPi, deg_to_rad(1.0), 0.1, 6.0}));
  ASSERT_EQ(f.runs.size(), 1U);
  EXPECT_NEAR(rad_to_deg(f.size), 30.0, 1e-6);
}

TEST(Missing, EmptyAndSingleBeamsAreHarmless) {
  EXPECT_TRUE(features(make_scan({}, {})).runs.empty());
  const std::vector<float> one{1.0F};
  EXPECT_TRUE(features(make_scan(one, {})).runs.empty());
}

}  // namespace
}  // namespace phasescan::missing_test
