// What is made of what the search saw: ambiguity, covariance, confidence; and the rules of its lists.
#include "match/confidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "match/hypothesis_list.hpp"

namespace phasescan::confidence_test {
namespace {

Hypothesis hypothesis(const Pose2& pose, double score) {
  Hypothesis h{};
  h.T_ref_scan = pose;
  h.score = score;
  return h;
}

/// A good match in a room: sure to 1 cm and 0.01 rad, nothing else explains the scans.
SearchOutcome in_a_room() {
  SearchOutcome outcome;
  outcome.hypotheses = {hypothesis({1.0, 0.5, 0.3}, 0.9), hypothesis({-2.0, 0.5, 0.3}, 0.3)};
  outcome.margin = 0.6;
  outcome.profile = 0.3;
  outcome.refined.information = Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal();
  outcome.refined.partners = 200;
  outcome.refined.mean_cost = 1.0;
  outcome.evidence.hits = 200;
  outcome.evidence.matched = 180.0;
  outcome.evidence.stray = 5.0;
  return outcome;
}

TEST(Confidence, ACovarianceFollowsHowFarPartnersLieApart) {
  SearchOutcome outcome = in_a_room();
  const double usual = covariance_of(outcome)(0, 0);
  EXPECT_GT(usual, 1.5e-4) << "the kernel shrinks what partners seem to be off by";
  EXPECT_LT(usual, 4e-4);
  outcome.refined.mean_cost = 0.5;
  EXPECT_NEAR(covariance_of(outcome)(0, 0), 0.5 * usual, 1e-9);
  outcome.refined.mean_cost = 0.0;
  EXPECT_GT(covariance_of(outcome)(0, 0), 0.02 * usual) << "surfaces without any noise are not known without end";
  EXPECT_FALSE(is_ambiguous(outcome));
}

TEST(Confidence, ACovarianceIsAsWideAsTheResidualsShow) {
  SearchOutcome outcome = in_a_room();
  const Eigen::Matrix3d usual = covariance_of(outcome);
  outcome.residual_covariance = Eigen::Vector3d(1e-9, 4e-3, 1e-9).asDiagonal();
  Eigen::Matrix3d covariance = covariance_of(outcome);
  EXPECT_NEAR(covariance(0, 0), usual(0, 0), 1e-9) << "never surer than the noise of the ranges";
  EXPECT_NEAR(covariance(1, 1), 8e-3, 1e-6);
  EXPECT_NEAR(covariance(2, 2), usual(2, 2), 1e-9);
  // Where two in three hits find no partner, those that do were chosen by how well they fit.
  outcome.evidence.matched = 60.0;
  covariance = covariance_of(outcome);
  EXPECT_NEAR(covariance(1, 1), 4.0 * 8e-3, 1e-6);
}

TEST(Confidence, ARevolutionThatTurnsTurnsThePose) {
  SearchOutcome outcome = in_a_room();
  const Eigen::Matrix3d usual = covariance_of(outcome);
  outcome.scan_turn_variance = 1e-4;
  EXPECT_NEAR(covariance_of(outcome)(2, 2), usual(2, 2) + 1e-4, 1e-9);
  EXPECT_NEAR(covariance_of(outcome)(0, 0), usual(0, 0), 1e-9);
  // A turn of the reference moves the scan around it, (1, 0.5) away.
  outcome.scan_turn_variance = 0.0;
  outcome.reference_turn_variance = 1e-4;
  const Eigen::Matrix3d covariance = covariance_of(outcome) - usual;
  EXPECT_NEAR(covariance(2, 2), 1e-4, 1e-9);
  EXPECT_NEAR(covariance(0, 0), 0.25e-4, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 1e-4, 1e-9);
  EXPECT_NEAR(covariance(0, 2), -0.5e-4, 1e-9);
}

TEST(Confidence, WhereThePoseSlidesNothingIsKnownAlong) {
  // Either is enough: the score hardly drops a little way on, or what holds the pose is known to 5 cm only.
  for (const bool by_profile : {true, false}) {
    SearchOutcome outcome = in_a_room();
    outcome.refined.information = Eigen::Vector3d(by_profile ? 1e3 : 100.0, 1e5, 1e5).asDiagonal();
    EXPECT_EQ(is_ambiguous(outcome), !by_profile);
    outcome.profile = by_profile ? 0.001 : 0.3;
    EXPECT_TRUE(is_ambiguous(outcome));
    const Eigen::Matrix3d covariance = covariance_of(outcome);
    EXPECT_NEAR(covariance(0, 0), 100.0, 1.0) << "as far as such a sensor sees";
    EXPECT_LT(covariance(1, 1), 1e-3);
  }
}

TEST(Confidence, WhereTwoPosesTieTheCovarianceReachesFromOneToTheOther) {
  SearchOutcome outcome = in_a_room();
  outcome.hypotheses[1].score = outcome.hypotheses[0].score;
  outcome.margin = 0.0;
  EXPECT_TRUE(is_ambiguous(outcome));
  EXPECT_NEAR(covariance_of(outcome)(0, 0), 0.5 * 3.0 * 3.0, 0.01) << "half of the squared distance";
  EXPECT_LT(covariance_of(outcome)(1, 1), 1e-3);
  EXPECT_EQ(weight_beside_best(outcome, 1), 1.0);
  outcome.hypotheses[1].score -= 0.05;
  EXPECT_NEAR(weight_beside_best(outcome, 1), 1.0 / std::numbers::e, 1e-9);
}

TEST(Confidence, FallsWithEachDoubt) {
  const auto odds_of = [](const SearchOutcome& outcome) {
    const double confidence = confidence_of(confidence_features(outcome));
    return confidence / (1.0 - confidence);
  };
  const auto odds_with = [&](auto&& change) {
    SearchOutcome outcome = in_a_room();
    change(outcome);
    return odds_of(outcome);
  };
  const double sure = odds_of(in_a_room());
  EXPECT_GT(sure, 9.0);
  EXPECT_LT(odds_with([](SearchOutcome& o) { o.evidence.violation = 40.0, o.evidence.matched = 140.0; }), 0.5 * sure);
  EXPECT_LT(odds_with([](SearchOutcome& o) { o.margin = 0.06; }), 0.5 * sure);
  EXPECT_LT(odds_with([](SearchOutcome& o) { o.hypotheses[0].score = 0.1, o.evidence.matched = 80.0; }), 0.5 * sure);
  EXPECT_EQ(confidence_features(SearchOutcome()).value[0], 0.0) << "nothing was found";
}

TEST(HypothesisList, PosesThatADetailTellsApartAreAnswersOfTheirOwn) {
  const double scale = 6.0;
  EXPECT_TRUE(same_answer({1.0, 0.0, 0.0}, {1.1, 0.0, 0.02}, scale));
  EXPECT_FALSE(same_answer({1.0, 0.0, 0.0}, {1.2, 0.0, 0.0}, scale));
  EXPECT_FALSE(same_answer({1.0, 0.0, 0.0}, {1.0, 0.0, 0.1}, scale));
  EXPECT_FALSE(same_answer({1.0, 0.0, 0.0}, {1.1, 0.0, 0.0}, 2.0)) << "a smaller place has finer details";
  std::vector<Hypothesis> all = {hypothesis({1.0, 0.0, 0.0}, 0.5), hypothesis({1.05, 0.0, 0.0}, 0.8),
                                 hypothesis({2.0, 0.0, 0.0}, 0.6)},
                          distinct;
  sort_distinct(all, scale, distinct);
  ASSERT_EQ(distinct.size(), 2u);
  EXPECT_EQ(distinct[0].score, 0.8);
  EXPECT_EQ(distinct[1].score, 0.6);
}

TEST(HypothesisList, OneThatTurnedIsKeptAmongThoseOfOneHeading) {
  std::vector<Hypothesis> sorted;
  for (int k = 0; k < 6; ++k) sorted.push_back(hypothesis({0.5 * k, 0.0, 0.1}, 0.9 - 0.1 * k));
  sorted.push_back(hypothesis({0.0, 0.0, 0.1 + kPi}, 0.2));
  std::vector<Hypothesis> kept = sorted;
  keep_finalists(4, kept);
  ASSERT_EQ(kept.size(), 4u);
  EXPECT_GT(std::abs(kept[3].T_ref_scan.theta), 2.0);
  EXPECT_EQ(kept[2].score, sorted[2].score);
  sorted.pop_back();
  keep_finalists(4, sorted);
  EXPECT_NEAR(sorted[3].T_ref_scan.theta, 0.1, 1e-12) << "where there is none, the best stay";
}

TEST(HypothesisList, OfEqualsTheOneThatTurnedLessComesFirst) {
  std::vector<Hypothesis> sorted = {hypothesis({0.0, 0.0, 3.0}, 0.90), hypothesis({0.0, 0.0, 2.9}, 0.89),
                                    hypothesis({1.0, 0.0, 0.1}, 0.88), hypothesis({2.0, 0.0, 0.0}, 0.5)};
  std::vector<Hypothesis> narrow = sorted;
  EXPECT_FALSE(prefer_less_turn(0.01, narrow));
  EXPECT_EQ(narrow[0].score, 0.90);
  EXPECT_TRUE(prefer_less_turn(0.03, sorted));
  EXPECT_EQ(sorted[0].score, 0.88);
  EXPECT_EQ(sorted[1].score, 0.90) << "the others stay, in their order";
}

}  // namespace
}  // namespace phasescan::confidence_test
