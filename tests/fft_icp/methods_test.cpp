// Laws and hostile input for the five methods of [Jiang19].
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "config/config.hpp"
#include "phasescan/fft_icp/fft_icp.hpp"
#include "support/rooms.hpp"
#include "support/paths.hpp"

namespace phasescan::methods_test {
namespace {

constexpr FftIcpMethod kMethods[] = {FftIcpMethod::kIcp, FftIcpMethod::kNdt, FftIcpMethod::kFft, FftIcpMethod::kFftIcp1,
                                     FftIcpMethod::kFftIcp2};

class PaperMethods : public testing::TestWithParam<FftIcpMethod> {
 protected:
  FftIcpOptions options() const {
    FftIcpOptions o;
    o.fft_icp.method = GetParam();
    return o;
  }
  bool global() const { return GetParam() != FftIcpMethod::kIcp && GetParam() != FftIcpMethod::kNdt; }
  /// What the method can do at best: a pixel of the scan image, or points.
  double reach() const { return GetParam() == FftIcpMethod::kFft ? 0.05 : 0.02; }
  MatchResult match(const Scan& reference, const Scan& scan, const MatchHints& hints = {}) const {
    return match_fft_icp(reference, scan, options(), hints);
  }
};

void expect_near(const Pose2& got, const Pose2& expected, double metres, double degrees) {
  EXPECT_LT(translation_distance(got, expected), metres);
  EXPECT_LT(angle_distance(got.theta, expected.theta), deg_to_rad(degrees));
}

void expect_sane(const MatchResult& result) {
  EXPECT_TRUE(result.T_ref_scan.is_finite());
  EXPECT_TRUE(result.covariance.allFinite());
  EXPECT_LE(result.covariance.diagonal().maxCoeff(), 1e6 * 1.001);
  EXPECT_TRUE(std::isfinite(result.overlap));
  EXPECT_EQ(result.usable, result.status == MatchStatus::kConverged);
  EXPECT_FALSE(result.confidence.has_value());
}

TEST_P(PaperMethods, FindTheMotion) {
  const Scan reference = test::cast_room({}, 360, 0.01, 0.02, 1);
  std::vector<Pose2> truths{{0.1, 0.05, deg_to_rad(5)}, {-0.12, 0.1, deg_to_rad(-6)}};
  if (global())
    truths.insert(truths.end(),
                  {{0.5, -0.4, deg_to_rad(100)}, {-0.6, 0.3, deg_to_rad(-170)}, {0.2, 0.7, deg_to_rad(35)}});
  for (const Pose2& truth : truths) {
    const MatchResult result = match(reference, test::cast_room(truth, 360, 0.01, 0.02, 2));
    EXPECT_TRUE(result.usable);
    expect_near(result.T_ref_scan, truth, reach(), 1.0);
    expect_sane(result);
  }
}

TEST_P(PaperMethods, SwappingTheScansInvertsTheAnswer) {
  const Scan a = test::cast_room({}, 360, 0.01, 0.02, 3),
             b = test::cast_room({0.15, -0.1, deg_to_rad(6)}, 360, 0.01, 0.02, 4);
  expect_near(match(a, b).T_ref_scan, match(b, a).T_ref_scan.inverse(), 2.0 * reach(), 1.0);
}

TEST_P(PaperMethods, AngleMinOfEitherScanBelongsToItsOwnFrame) {
  // The same beams said to start elsewhere: the sensor frame is turned, and with it the answer.
  const Scan reference = test::cast_room({}, 360, 0.01);
  Scan scan = test::cast_room({0.1, 0.1, 0.05}, 360, 0.01);
  const Pose2 before = match(reference, scan).T_ref_scan;
  const double turn = global() ? 1.2 : 0.08;
  scan.geometry.angle_min -= turn;
  expect_near(match(reference, scan).T_ref_scan, before * Pose2{0.0, 0.0, turn}, 2.0 * reach(), 1.0);
}

TEST_P(PaperMethods, ClockwiseSensorsGiveTheSameAnswer) {
  const Pose2 truth{0.1, -0.08, 0.07};
  const Scan reference = test::cast_room({}, 360, 0.01, 0.0, 5, 6.0, kPi, true);
  expect_near(match(reference, test::cast_room(truth, 360, 0.01, 0.0, 6, 6.0, kPi, true)).T_ref_scan, truth, reach(),
              1.0);
}

/// The same beams listed last to first.
Scan listed_backwards(const Scan& scan) {
  Scan out = scan;
  std::reverse(out.ranges.begin(), out.ranges.end());
  std::reverse(out.states.begin(), out.states.end());
  std::reverse(out.angles.begin(), out.angles.end());
  out.geometry.angle_min = scan.angle(scan.size() - 1);
  out.geometry.angle_increment = -scan.geometry.angle_increment;
  return out;
}

/// The same with a list of angles.
Scan with_listed_angles(const Scan& scan) {
  Scan out = scan;
  for (std::size_t i = 0; i < scan.size(); ++i) out.angles.push_back(static_cast<float>(wrap_positive(scan.angle(i))));
  return out;
}

TEST_P(PaperMethods, TheOrderInWhichBeamsAreListedDoesNotMatter) {
  for (const int beams : {360, 357, 700}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      Random random(seed);
      const Pose2 truth{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2)};
      const Scan reference = test::cast_room({}, beams, 0.01, 0.02, seed, 6.0, -3.0);
      const Scan scan = test::cast_room(truth, beams, 0.01, 0.02, seed + 10, 4.0, -3.0);
      const auto expect_same = [&](const Scan& a, const Scan& b, const MatchResult& expected) {
        const MatchResult got = match(a, b);
        expect_near(got.T_ref_scan, expected.T_ref_scan, 1e-6, 1e-4);
        EXPECT_EQ(got.status, expected.status);
        EXPECT_EQ(got.diagnostics.rotation_source, expected.diagnostics.rotation_source);
      };
      const MatchResult expected = match(reference, scan);
      expect_same(listed_backwards(reference), listed_backwards(scan), expected);
      expect_same(listed_backwards(reference), scan, expected);
      expect_same(reference, listed_backwards(scan), expected);
      const Scan listed_reference = with_listed_angles(reference), listed = with_listed_angles(scan);
      expect_same(listed_backwards(listed_reference), listed_backwards(listed), match(listed_reference, listed));
    }
  }
}

TEST_P(PaperMethods, AGuessIsTaken) {
  const Pose2 truth{1.0, -0.5, deg_to_rad(80)};
  MatchHints hints;
  hints.guess = truth * Pose2{0.05, 0.05, 0.03};
  const MatchResult result = match(test::cast_room({}, 360, 0.01), test::cast_room(truth, 360, 0.01), hints);
  EXPECT_EQ(result.diagnostics.rotation_source, RotationSource::kGuess);
  expect_near(result.T_ref_scan, truth, 0.06, 2.0);
}

TEST_P(PaperMethods, ATwistIsTakenOutOfTheScan) {
  const Twist2 twist{0.5, 0.0, deg_to_rad(90)};
  const int beams = 360;
  const double dt = 0.18 / beams;
  Scan scan = test::cast_room({}, beams);
  // Beam k is cast from where the sensor is by then.
  for (int k = 0; k < beams; ++k) {
    const Pose2 at = Pose2{0.1, 0.0, 0.05} * exp_twist(twist, k * dt);
    const Scan still = test::cast_room(at, beams);
    scan.ranges[static_cast<std::size_t>(k)] = still.ranges[static_cast<std::size_t>(k)];
    scan.states[static_cast<std::size_t>(k)] = still.states[static_cast<std::size_t>(k)];
  }
  scan.time_increment = dt;
  MatchHints hints;
  hints.scan_twist = twist;
  expect_near(match(test::cast_room({}, beams), scan, hints).T_ref_scan, {0.1, 0.0, 0.05}, reach(), 1.0);
}

TEST_P(PaperMethods, APreparedReferenceGivesTheSameBytes) {
  FftIcpMatcher matcher(options());
  const Scan reference = test::cast_room({}, 360, 0.01);
  const FftIcpReference prepared = matcher.prepare(reference);
  for (int i = 0; i < 5; ++i) {
    const Scan scan = test::cast_room({0.05 * i, -0.04 * i, 0.3 * i}, 360, 0.01, 0.02, 7);
    const MatchResult a = matcher.match(reference, scan), b = matcher.match(prepared, scan);
    EXPECT_EQ(a.T_ref_scan.x, b.T_ref_scan.x);
    EXPECT_EQ(a.T_ref_scan.y, b.T_ref_scan.y);
    EXPECT_EQ(a.T_ref_scan.theta, b.T_ref_scan.theta);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.status, b.status);
  }
}

TEST_P(PaperMethods, HopelessScansAreRefusedWithAReason) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scan room = test::cast_room({}, 360);
  const ScanGeometry geometry{-kPi, deg_to_rad(1.0), 0.15, 6.0};
  std::vector<float> one(360, 0.0F);
  one[17] = 2.0F;
  const Scan one_spot = make_scan(std::vector<float>(101, 2.0F), {}, std::vector<float>(101, 0.3F));
  for (const Scan& bad : {make_scan({}, {}), make_scan(std::vector<float>(360, 0.0F), geometry),
                          make_scan(std::vector<float>(360, nan), geometry), make_scan(one, geometry),
                          make_scan(std::vector<float>{2.0F}, {}), one_spot}) {
    for (const MatchResult& result : {match(room, bad), match(bad, room), match(bad, bad)}) {
      EXPECT_FALSE(result.usable);
      EXPECT_EQ(result.status, MatchStatus::kNoPoints);
      expect_sane(result);
    }
  }
}

TEST_P(PaperMethods, StrangeScansNeitherCrashNorGiveNan) {
  const ScanGeometry geometry{-kPi, deg_to_rad(1.0), 0.15, 0.0};
  std::vector<float> circle(360, 2.0F), wild(360, 2.0F), corridor(360, 0.0F), same(360, 0.0F), huge(360, 3e30F);
  wild[5] = 250000.0F;
  for (int i = 0; i < 360; ++i) {
    const double s = std::abs(std::sin(deg_to_rad(i - 180.0)));
    if (s > 0.17) corridor[static_cast<std::size_t>(i)] = static_cast<float>(1.0 / s);
  }
  std::fill(same.begin() + 100, same.begin() + 112, 1.0F);
  const Scan room = test::cast_room({}, 360);
  for (const auto& ranges : {circle, wild, corridor, same, huge}) {
    const Scan strange = make_scan(ranges, geometry);
    for (const MatchResult& result : {match(strange, strange), match(room, strange), match(strange, room)})
      expect_sane(result);
  }
}

TEST_P(PaperMethods, OneOddAngleIncrementIsNoTrap) {
  // All beams in nearly the same direction, or many turns in one scan.
  for (const double increment : {1e-12, 1.0, 100.0}) {
    const Scan scan = make_scan(std::vector<float>(100, 2.0F), {0.0, increment, 0.1, 6.0});
    expect_sane(match(scan, scan));
  }
}

TEST_P(PaperMethods, AMillionBeamsAreJustMoreWork) {
  const Scan scan = test::cast_room({}, 1000000);
  FftIcpOptions o = options();
  o.icp.max_iterations = o.ndt.max_iterations = 2;
  expect_sane(match_fft_icp(test::cast_room({0.05, 0.0, 0.02}, 360), scan, o));
}

INSTANTIATE_TEST_SUITE_P(All, PaperMethods, testing::ValuesIn(kMethods), [](const auto& param) {
  std::string name(to_string(param.param));
  std::erase(name, '-');
  return name;
});

TEST(FftIcp2, TakesTheRotationFromMissingDataWhereItIsSure) {
  // A door-like gap of 60 and one of 20 degrees, and walls elsewhere.
  auto with_gaps = [](const Pose2& pose) {
    Scan scan = test::cast_room(pose, 360, 0.01);
    for (int i = 0; i < 360; ++i) {
      const double world = rad_to_deg(wrap_angle(pose.theta + scan.angle(static_cast<std::size_t>(i))));
      if ((world > 20 && world < 80) || (world > -120 && world < -100)) {
        scan.ranges[static_cast<std::size_t>(i)] = std::numeric_limits<float>::quiet_NaN();
        scan.states[static_cast<std::size_t>(i)] = BeamState::kNoReturn;
      }
    }
    return scan;
  };
  FftIcpOptions options;
  options.fft_icp.method = FftIcpMethod::kFftIcp2;
  const Pose2 truth{0.05, 0.03, deg_to_rad(140)};
  const MatchResult result = match_fft_icp(with_gaps({}), with_gaps(truth), options);
  EXPECT_EQ(result.diagnostics.rotation_source, RotationSource::kMissingData);
  expect_near(result.T_ref_scan, truth, 0.02, 0.5);
  options.fft_icp.method = FftIcpMethod::kFftIcp1;
  EXPECT_EQ(match_fft_icp(with_gaps({}), with_gaps(truth), options).diagnostics.rotation_source,
            RotationSource::kSpectrum);
}

TEST(PaperStrict, TheConfigurationLoadsAndEveryMethodFindsASmallMotion) {
  const AnyMatchOptions options = load_config(test::source_dir() + "/configs/paper-strict.yaml").match;
  EXPECT_EQ(options.translation.mode, TranslationMode::kProjections);
  EXPECT_EQ(options.translation.whitening, 1.0);
  EXPECT_EQ(options.icp.gate_m, 0.0);
  const Pose2 truth{0.05, -0.05, deg_to_rad(5)};
  for (const FftIcpMethod method : kMethods) {
    const MatchResult result =
        match_fft_icp(test::cast_room({}, 360), test::cast_room(truth, 360), options.for_fft_icp(method));
    expect_sane(result);
    expect_near(result.T_ref_scan, truth, 0.1, 3.0);
  }
}

TEST(FftIcpMatcher, AReferenceOfAnotherMethodIsTheCallersMistake) {
  FftIcpOptions options;
  FftIcpMatcher two(options);
  options.fft_icp.method = FftIcpMethod::kIcp;
  FftIcpMatcher icp(options);
  const Scan room = test::cast_room({}, 90);
  EXPECT_THROW(two.match(icp.prepare(room), room), std::invalid_argument);
}

TEST(FftIcpMatcher, AnOptionOutOfBoundsIsNamed) {
  FftIcpOptions options;
  options.icp.trim = 0.0;
  try {
    FftIcpMatcher matcher(options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("icp.trim"), std::string::npos);
  }
}

TEST(FftMethods, TheAnswerDoesNotDependOnTheFftLibrary) {
  // What the build with FFTW answers; a build with KissFFT runs the same test.
  const Scan reference = test::cast_room({}, 360, 0.01, 0.02, 1),
             scan = test::cast_room({0.5, -0.4, 1.8}, 360, 0.01, 0.02, 2);
  FftIcpOptions options;
  options.fft_icp.method = FftIcpMethod::kFft;
  expect_near(match_fft_icp(reference, scan, options).T_ref_scan, {0.504449, -0.400109, 1.799646}, 1e-4, 0.01);
  options.fft_icp.method = FftIcpMethod::kFftIcp2;
  expect_near(match_fft_icp(reference, scan, options).T_ref_scan, {0.499738, -0.400752, 1.800089}, 1e-4, 0.01);
}

}  // namespace
}  // namespace phasescan::methods_test
