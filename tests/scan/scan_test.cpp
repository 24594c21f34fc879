#include "phasescan/scan/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scan/points.hpp"

namespace phasescan::scan_test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Scan, SaysWhyEachBeamIsMissing) {
  const std::vector<float> raw{1.0F, 0.0F, kInf, -kInf, kNan, -2.0F, 0.05F, 9.0F};
  const Scan scan = make_scan(raw, {0.0, 0.1, 0.15, 6.0});
  const std::vector<BeamState> expected{BeamState::kHit,     BeamState::kNoReturn,  BeamState::kOutOfRange,
                                        BeamState::kTooNear, BeamState::kInvalid,   BeamState::kInvalid,
                                        BeamState::kTooNear, BeamState::kOutOfRange};
  EXPECT_EQ(scan.states, expected);
  for (std::size_t i = 1; i < raw.size(); ++i) EXPECT_TRUE(std::isnan(scan.ranges[i])) << i;
  EXPECT_EQ(scan.hit_count(), 1U);
}

TEST(Scan, NonsenseLimitsAreUnknown) {
  const std::vector<float> raw{1.0F, 50.0F};
  for (const double high : {0.0, -1.0, static_cast<double>(kNan), static_cast<double>(kInf)}) {
    const Scan scan = make_scan(raw, {0.0, 0.1, 0.15, high});
    EXPECT_EQ(scan.hit_count(), 2U);
    EXPECT_DOUBLE_EQ(scan.effective_range_max(), 50.0);
  }
}

TEST(Scan, RawRangesMakeTheSameScanAgain) {
  const std::vector<float> raw{1.0F, 0.0F, kInf, -kInf, kNan, -2.0F, 0.05F, 9.0F};
  const Scan scan = make_scan(raw, {0.0, -0.1, 0.15, 6.0});
  std::vector<float> again;
  for (std::size_t i = 0; i < scan.size(); ++i) again.push_back(raw_range(scan, i));
  EXPECT_EQ(make_scan(again, scan.geometry).states, scan.states);
}

TEST(Scan, CallersMistakesNameTheField) {
  const std::vector<float> raw{1.0F, 2.0F};
  for (const double increment : {0.0, static_cast<double>(kNan)}) {
    try {
      make_scan(raw, {0.0, increment, 0.0, 0.0});
      FAIL();
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("angle_increment"), std::string::npos);
    }
  }
  const std::vector<float> angles{0.0F};
  EXPECT_THROW(make_scan(raw, {}, angles), std::invalid_argument);
}

TEST(Points, ClockwiseSensorsTurnTheOtherWay) {
  const std::vector<float> raw{1.0F, 1.0F};
  ScanPoints points;
  scan_to_points(make_scan(raw, {0.0, -kPi / 2, 0.0, 0.0}), points);
  EXPECT_EQ(points.beam, (std::vector<int>{1, 0}));  // points stand counter-clockwise whichever way beams are listed
  EXPECT_NEAR(points.x[1], 1.0, 1e-6);
  EXPECT_NEAR(points.y[0], -1.0, 1e-6);
}

TEST(Points, TheTwistIsTakenOut) {
  // A wall point seen by each beam while the sensor turns: with the twist all beams see the same point.
  const double omega = 1.0, dt = 0.01;
  const std::vector<float> raw(50, 2.0F);
  Scan scan = make_scan(raw, {0.0, -omega * dt, 0.0, 0.0});
  scan.time_increment = dt;
  ScanPoints points;
  scan_to_points(scan, points, 0.0, {0.0, 0.0, omega});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points.x[i], 2.0, 1e-5);
    EXPECT_NEAR(points.y[i], 0.0, 1e-5);
  }
}

TEST(MakeScan, AnglesThatNoSensorHasAreTheCallersMistake) {
  const std::vector<float> raw{1.0F, 2.0F, 3.0F}, far{0.0F, 0.1F, 2e4F};
  EXPECT_THROW(make_scan(raw, {1e35, 0.1, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(make_scan(raw, {0.0, 1e30, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(make_scan(raw, {0.0, -6e3, 0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(make_scan(raw, {}, far), std::invalid_argument);
  EXPECT_NO_THROW(make_scan(raw, {0.0, 4e3, 0.0, 0.0}));
}

TEST(MakeScan, RangesBeyondAnySensorAreInvalidAndSuchLimitsUnknown) {
  const std::vector<float> raw{2.0F, 3e30F, 1e6F, 1.1e6F, std::numeric_limits<float>::max()};
  const Scan open = make_scan(raw, {0.0, 0.1, 0.0, 0.0});
  EXPECT_EQ(open.states, (std::vector<BeamState>{BeamState::kHit, BeamState::kInvalid, BeamState::kHit,
                                                 BeamState::kInvalid, BeamState::kInvalid}));
  const Scan absurd = make_scan(raw, {0.0, 0.1, 0.0, 1e300});
  EXPECT_EQ(absurd.geometry.range_max, 0.0);
  EXPECT_EQ(absurd.states, open.states);
  EXPECT_EQ(make_scan(raw, {0.0, 0.1, 2e6, 0.0}).geometry.range_min, 0.0);
  // Some drivers mark what lies beyond their reach with the largest number there is.
  EXPECT_EQ(make_scan(raw, {0.0, 0.1, 0.0, 8.0}).states[4], BeamState::kOutOfRange);
}

}  // namespace
}  // namespace phasescan::scan_test
