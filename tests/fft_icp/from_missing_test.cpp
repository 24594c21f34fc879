#include "fft_icp/missing/from_missing.hpp"

#include <gtest/gtest.h>

#include "phasescan/core/pose2.hpp"
#include "core/random.hpp"

namespace phasescan::from_missing_test {
namespace {

MissingFeatures random_features(Random& random, int runs) {
  MissingFeatures f;
  f.full_turn = true;
  double at = random.uniform(-kPi, kPi);
  for (int i = 0; i < runs; ++i) {
    at += random.uniform(0.2, 0.8);
    const double width = random.uniform(0.15, 0.5);
    f.runs.push_back({wrap_angle(at), width});
    f.size += width;
    at += width;
  }
  return f;
}

MissingFeatures turned(const MissingFeatures& f, double angle) {
  MissingFeatures out = f;
  for (MissingRun& run : out.runs) run.start = wrap_angle(run.start + angle);
  return out;
}

/// Width of the symmetric difference by looking at every thousandth of the circle.
double slow_error(const MissingFeatures& a, const MissingFeatures& b, double alpha) {
  const auto inside = [](const MissingFeatures& f, double angle) {
    for (const MissingRun& run : f.runs) {
      if (wrap_positive(angle - run.start) < run.width) return true;
    }
    return false;
  };
  const int n = 20000;
  int differ = 0;
  for (int i = 0; i < n; ++i) {
    const double angle = kTwoPi * (i + 0.5) / n;
    differ += inside(a, angle) != inside(b, angle - alpha);
  }
  return kTwoPi * differ / n / (a.size + b.size);
}

TEST(MissingError, IsTheSymmetricDifferenceOfTheSets) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const MissingFeatures a = random_features(random, 3), b = random_features(random, 4);
    const double alpha = random.uniform(-kPi, kPi);
    EXPECT_NEAR(missing_error(a, b, alpha), slow_error(a, b, alpha), 5e-3);
  }
}

TEST(MissingRotation, IsTheExactMinimumOnTheWholeCircle) {
  Random random(2);
  MissingMatcher matcher;
  for (int i = 0; i < 100; ++i) {
    const MissingFeatures a = random_features(random, 1 + i % 4), b = random_features(random, 1 + (i / 4) % 4);
    const MissingRotation found = matcher.match(a, b, MissingOptions{});
    EXPECT_NEAR(found.error, missing_error(a, b, found.theta), 1e-9);
    for (int k = 0; k < 720; ++k) EXPECT_LE(found.error, missing_error(a, b, kTwoPi * k / 720) + 1e-9);
  }
}

TEST(MissingRotation, FindsTheTurnOfTheSameFeatures) {
  Random random(3);
  MissingMatcher matcher;
  for (int i = 0; i < 50; ++i) {
    const MissingFeatures scan = random_features(random, 3);
    const double turn = random.uniform(-kPi, kPi);
    const MissingRotation found = matcher.match(turned(scan, turn), scan, MissingOptions{});
    EXPECT_LT(found.error, 1e-9);
    EXPECT_LT(angle_distance(found.theta, turn), 1e-6);
  }
}

TEST(MissingRotation, AnswersTheMiddleOfAPlateau) {
  MissingFeatures wide, narrow;
  wide.runs = {{0.0, 1.0}};
  narrow.runs = {{0.0, 0.4}};
  wide.size = 1.0;
  narrow.size = 0.4;
  EXPECT_NEAR(MissingMatcher().match(wide, narrow, MissingOptions{}).theta, 0.3, 1e-9);
  // The same across the seam of alpha.
  narrow.runs[0].start = 0.3;
  EXPECT_NEAR(MissingMatcher().match(wide, narrow, MissingOptions{}).theta, 0.0, 1e-9);
}

TEST(MissingRotation, GatesRefuse) {
  MissingMatcher matcher;
  Random random(4);
  const MissingFeatures f = random_features(random, 3);
  MissingOptions options;
  EXPECT_TRUE(matcher.match(f, f, options).accepted);
  MissingFeatures half_view = f;
  half_view.full_turn = false;
  EXPECT_FALSE(matcher.match(half_view, f, options).accepted) << "a border of the view is no thing in the world";
  options.min_size_deg = 180.0;
  EXPECT_FALSE(matcher.match(f, f, options).accepted) << "too little is missing";
  options = {};
  options.max_error = 0.1;
  EXPECT_FALSE(matcher.match(f, random_features(random, 2), options).accepted) << "they do not agree";
}

TEST(MissingRotation, TwoRunsOppositeEachOtherAreAmbiguous) {
  MissingFeatures f;
  f.full_turn = true;
  f.runs = {{0.0, 0.6}, {kPi, 0.6}};
  f.size = 1.2;
  const MissingRotation found = MissingMatcher().match(f, f, MissingOptions{});
  EXPECT_NEAR(found.margin, 0.0, 1e-9);
  EXPECT_FALSE(found.accepted);
}

TEST(MissingRotation, NothingMissingOrEverythingMissingIsNoAnswer) {
  MissingFeatures none, all;
  none.full_turn = all.full_turn = true;
  all.runs = {{0.0, kTwoPi}};
  all.size = kTwoPi;
  EXPECT_FALSE(MissingMatcher().match(none, none, MissingOptions{}).accepted);
  EXPECT_FALSE(MissingMatcher().match(all, all, MissingOptions{}).accepted);
}

}  // namespace
}  // namespace phasescan::from_missing_test
