#include "eval/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.hpp"

namespace phasescan::statistics_test {
namespace {

TEST(Wilson, AgreesWithPublishedValues) {
  // R's prop.test(k, n, correct = FALSE).
  const auto expect = [](std::size_t hits, std::size_t n, double low, double high) {
    const Interval i = wilson_interval(hits, n);
    EXPECT_NEAR(i.low, low, 5e-5) << hits << "/" << n;
    EXPECT_NEAR(i.high, high, 5e-5) << hits << "/" << n;
  };
  expect(81, 263, 0.25526, 0.36621);  // [Newcombe98] table I
  expect(15, 148, 0.06239, 0.16053);
  expect(1, 29, 0.00611, 0.17176);
  expect(0, 20, 0.0, 0.16113);
  expect(20, 20, 0.83887, 1.0);
}

TEST(Wilson, HoldsTheShareAndIsSymmetric) {
  for (std::size_t n : {1u, 7u, 75u, 3000u}) {
    for (std::size_t k = 0; k <= n; k += std::max<std::size_t>(1, n / 13)) {
      const Interval a = wilson_interval(k, n), b = wilson_interval(n - k, n);
      const double p = static_cast<double>(k) / static_cast<double>(n);
      EXPECT_LE(a.low, p);
      EXPECT_GE(a.high, p);
      EXPECT_NEAR(a.low, 1.0 - b.high, 1e-12);
    }
  }
  EXPECT_EQ(wilson_interval(0, 0).low, 0.0);
  EXPECT_EQ(wilson_interval(0, 0).high, 1.0);
}

TEST(Moments, ByHand) {
  const std::vector<double> v{1, 2, 4, 9};
  const Moments m = moments(v);
  EXPECT_DOUBLE_EQ(m.mean, 4.0);
  EXPECT_DOUBLE_EQ(m.variance, (9 + 4 + 0 + 25) / 3.0);
  EXPECT_DOUBLE_EQ(m.std, std::sqrt(38.0 / 3.0));
  EXPECT_DOUBLE_EQ(m.median, 3.0);
  EXPECT_TRUE(std::isnan(moments({}).mean));
  EXPECT_EQ(moments(std::vector<double>{5.0}).variance, 0.0);
}

TEST(Quantile, ByHand) {
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2, 5}, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile({1, 2}, 0.25), 1.25);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.99), 7.0);
  EXPECT_DOUBLE_EQ(quantile({1, 2, 3}, 1.0), 3.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

std::vector<Judgement> random_judgements(std::uint64_t seed, std::size_t n) {
  Random random(seed);
  std::vector<Judgement> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double c = static_cast<double>(random.below(21)) / 20.0;  // many ties, both ends
    out.push_back({c, random.chance(0.3 + 0.6 * c)});
  }
  return out;
}

TEST(AreaUnderRoc, AgreesWithCountingAllPairs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Judgement> all = random_judgements(seed, 60);
    double better = 0.0, pairs = 0.0;
    for (const Judgement& a : all) {
      for (const Judgement& b : all) {
        if (!a.right || b.right) continue;
        pairs += 1.0;
        better += a.confidence > b.confidence ? 1.0 : a.confidence == b.confidence ? 0.5 : 0.0;
      }
    }
    ASSERT_GT(pairs, 0.0);
    EXPECT_NEAR(area_under_roc(all), better / pairs, 1e-12) << "seed " << seed;
  }
}

TEST(AreaUnderRoc, NeedsBothKinds) {
  EXPECT_TRUE(std::isnan(area_under_roc(std::vector<Judgement>{{0.5, true}, {0.7, true}})));
  EXPECT_TRUE(std::isnan(area_under_roc({})));
  EXPECT_DOUBLE_EQ(area_under_roc(std::vector<Judgement>{{0.9, true}, {0.1, false}}), 1.0);
}

TEST(CalibrationError, AgreesWithBinningByHand) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::vector<Judgement> all = random_judgements(seed, 200);
    double sum = 0.0;
    for (int bin = 0; bin < 10; ++bin) {
      double n = 0, confidence = 0, right = 0;
      for (const Judgement& j : all) {
        const bool inside =
            bin == 9 ? j.confidence >= 0.9 : j.confidence * 10.0 >= bin && j.confidence * 10.0 < bin + 1;
        if (!inside) continue;
        n += 1;
        confidence += j.confidence;
        right += j.right;
      }
      if (n > 0) sum += n / 200.0 * std::abs(right / n - confidence / n);
    }
    EXPECT_NEAR(calibration_error(all), sum, 1e-12) << "seed " << seed;
  }
  EXPECT_NEAR(calibration_error(std::vector<Judgement>{{1.0, true}, {1.0, true}}), 0.0, 1e-15);
  EXPECT_NEAR(calibration_error(std::vector<Judgement>{{1.0, false}}), 1.0, 1e-15);
  EXPECT_TRUE(std::isnan(calibration_error({})));
}

}  // namespace
}  // namespace phasescan::statistics_test
