#include "eval/pair_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace phasescan::pair_rows_test {
namespace {

ScanPair make_pair(const std::string& dataset, const std::string& cls, std::optional<Pose2> truth) {
  ScanPair pair;
  pair.dataset = dataset;
  pair.cls = cls;
  pair.truth = truth;
  return pair;
}

MatchResult answer(const Pose2& pose, bool usable) {
  MatchResult result;
  result.T_ref_scan = pose;
  result.usable = usable;
  result.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
  return result;
}

TEST(Judge, SuccessIsCloserThanTenCentimetresAndThreeDegreesWhateverUsableSays) {
  const ScanPair pair = make_pair("d", "small", Pose2{1.0, 2.0, kPi - 0.01});
  const auto right = [&](double dx, double dy, double turn_deg, bool usable) {
    return judge(pair, answer({1.0 + dx, 2.0 + dy, wrap_angle(kPi - 0.01 + deg_to_rad(turn_deg))}, usable), 0, 0.5)
        .right;
  };
  EXPECT_TRUE(right(0.0, 0.0, 0.0, false));
  EXPECT_TRUE(right(0.0999, 0.0, 2.99, true));  // the heading crosses the seam
  EXPECT_FALSE(right(0.0999, 0.02, 0.0, true));
  EXPECT_FALSE(right(0.0, 0.0, -3.01, true));
  EXPECT_FALSE(right(0.0, 0.0, 180.0, true));
}

TEST(Judge, NeesIsTheErrorInUnitsOfItsCovariance) {
  const ScanPair pair = make_pair("d", "small", Pose2{});
  EXPECT_NEAR(judge(pair, answer({0.01, -0.02, 0.01}, true), 0, 0.5).nees, 1.0 + 4.0 + 1.0, 1e-9);
  MatchResult singular = answer({0.01, 0, 0}, true);
  singular.covariance.setZero();
  EXPECT_TRUE(std::isnan(judge(pair, singular, 0, 0.5).nees));
}

TEST(PairRows, HonestyCountsByHand) {
  std::vector<PairOutcome> outcomes;
  const ScanPair known = make_pair("a", "small", Pose2{}), none = make_pair("a", "none", std::nullopt);
  outcomes.push_back(judge(known, answer({}, true), 0, 1));                // right & usable
  outcomes.push_back(judge(known, answer({0.05, 0, 0}, false), 0, 1));     // right & refused
  outcomes.push_back(judge(known, answer({0.5, 0, 0}, false), 0, 1));      // wrong & refused
  outcomes.push_back(judge(known, answer({0.5, 0, 0}, true), 0, 1));       // wrong & usable
  outcomes.push_back(judge(known, answer({-0.03, 0, 0.01}, true), 0, 1));  // right & usable
  outcomes.push_back(judge(none, answer({}, true), 0, 1));                 // any usable answer is wrong
  outcomes.push_back(judge(none, answer({}, false), 0, 1));
  const std::vector<BenchRow> rows = pair_rows(outcomes);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].cls, "small");
  EXPECT_EQ(rows[0].n, 5u);
  EXPECT_EQ(rows[0].right, 3u);
  EXPECT_DOUBLE_EQ(rows[0].success(), 0.6);
  EXPECT_EQ(rows[0].right_usable, 2u);
  EXPECT_EQ(rows[0].right_refused, 1u);
  EXPECT_EQ(rows[0].wrong_refused, 1u);
  EXPECT_EQ(rows[0].wrong_usable, 1u);
  EXPECT_NEAR(rows[0].x_m.mean, 0.08 / 3.0, 1e-12);
  EXPECT_NEAR(rows[0].x_m.median, 0.03, 1e-12);
  EXPECT_NEAR(rows[0].rotation_deg.mean, rad_to_deg(0.01) / 3.0, 1e-9);
  EXPECT_DOUBLE_EQ(rows[0].nees_below, 1.0 / 3.0);  // of the usable: 0; 2500; 9 + 1
  EXPECT_EQ(rows[1].cls, "none");
  EXPECT_EQ(rows[1].with_truth, 0u);
  EXPECT_TRUE(std::isnan(rows[1].success()));
  EXPECT_EQ(rows[1].wrong_usable, 1u);
  EXPECT_EQ(rows[1].wrong_refused, 1u);
}

TEST(PairRows, OrderIsKnownClassesThenOthersAndTotalsAddUp) {
  std::vector<PairOutcome> outcomes;
  for (const char* cls : {"weird", "global", "none", "small"}) {
    for (const char* dataset : {"b", "a"}) {
      for (std::size_t method = 0; method < 2; ++method) {
        const bool none = std::string(cls) == "none";
        outcomes.push_back(judge(make_pair(dataset, cls, none ? std::nullopt : std::optional<Pose2>(Pose2{})),
                                 answer({}, true), method, 1));
      }
    }
  }
  EXPECT_EQ(classes_in_order(outcomes), (std::vector<std::string>{"small", "global", "none", "weird"}));
  EXPECT_EQ(datasets_in_order(outcomes), (std::vector<std::string>{"b", "a"}));
  const std::vector<BenchRow> rows = pair_rows(outcomes);
  ASSERT_EQ(rows.size(), 16u);
  EXPECT_EQ(rows[0].dataset, "b");
  EXPECT_EQ(rows[0].cls, "small");
  EXPECT_EQ(rows[1].method, 1u);
  const std::vector<BenchRow> totals = pair_totals(outcomes);
  ASSERT_EQ(totals.size(), 2u * 2u + 4u * 2u + 2u);
  EXPECT_EQ(totals.back().n, 8u);
  EXPECT_EQ(totals.back().right, 6u);
  EXPECT_EQ(totals.back().wrong_usable, 2u);
  EXPECT_EQ(totals.front().cls, "all");
  EXPECT_EQ(totals.back().dataset, "all");
}

TEST(ScanOverlap, IsOneForTheSameScanAndFallsAsTheSceneLeavesTheView) {
  std::vector<float> ranges(360, 3.0F);
  const Scan ring = make_scan(ranges, {-kPi, kTwoPi / 360, 0.1, 10});
  EXPECT_DOUBLE_EQ(scan_overlap(ring, ring, {}), 1.0);
  std::vector<float> half = ranges;
  std::fill(half.begin(), half.begin() + 180, 0.0F);
  const Scan half_ring = make_scan(half, {-kPi, kTwoPi / 360, 0.1, 10});
  EXPECT_NEAR(scan_overlap(ring, half_ring, {}), 0.5, 0.03);
  EXPECT_NEAR(scan_overlap(half_ring, ring, {}), 0.5, 0.03);  // the smaller share counts, whichever side it is on
  EXPECT_LT(scan_overlap(ring, ring, {2.0, 0, 0}), 0.2);
  EXPECT_EQ(scan_overlap(make_scan({}, {}), ring, {}), 0.0);
}

}  // namespace
}  // namespace phasescan::pair_rows_test
