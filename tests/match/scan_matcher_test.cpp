#include "phasescan/match/scan_matcher.hpp"

#include <gtest/gtest.h>

#include "support/rooms.hpp"

namespace phasescan {
namespace {

MatchOptions method_options(MatchMethod method) {
  MatchOptions options;
  options.match.method = method;
  return options;
}

TEST(ScanMatcher, IcpFindsASmallMotion) {
  const Pose2 truth{0.1, -0.05, deg_to_rad(4)};
  const Scan reference = test::cast_room({}, 360), scan = test::cast_room(truth, 360);
  const MatchResult result = match_scans(reference, scan, method_options(MatchMethod::kIcp));
  EXPECT_TRUE(result.usable);
  EXPECT_LT(translation_distance(result.T_ref_scan, truth), 0.02);
  EXPECT_LT(angle_distance(result.T_ref_scan.theta, truth.theta), deg_to_rad(0.5));
}

TEST(ScanMatcher, APreparedReferenceGivesTheSameAnswer) {
  ScanMatcher matcher(method_options(MatchMethod::kIcp));
  const Scan reference = test::cast_room({}, 360), scan = test::cast_room({0.1, 0.1, 0.1}, 360);
  const MatchResult raw = matcher.match(reference, scan);
  const MatchResult prepared = matcher.match(matcher.prepare(reference), scan);
  EXPECT_EQ(raw.T_ref_scan.x, prepared.T_ref_scan.x);
  EXPECT_EQ(raw.T_ref_scan.y, prepared.T_ref_scan.y);
  EXPECT_EQ(raw.T_ref_scan.theta, prepared.T_ref_scan.theta);
}

TEST(ScanMatcher, ManyScansGiveTheSameAnswersForAnyNumberOfThreads) {
  const Scan reference = test::cast_room({}, 360);
  std::vector<Scan> scans;
  for (int i = 0; i < 7; ++i) scans.push_back(test::cast_room({0.02 * i, -0.03 * i, 0.03 * i}, 360));
  const MatchOptions options = method_options(MatchMethod::kIcp);
  const auto one = match_many(reference, scans, options, 1), three = match_many(reference, scans, options, 3);
  ASSERT_EQ(one.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(one[i].T_ref_scan.x, three[i].T_ref_scan.x);
    EXPECT_EQ(one[i].T_ref_scan.theta, three[i].T_ref_scan.theta);
  }
}

TEST(ScanMatcher, AReferenceOfAnotherMethodIsTheCallersMistake) {
  ScanMatcher icp(method_options(MatchMethod::kIcp)), other(method_options(MatchMethod::kFftIcp1));
  const Reference reference = icp.prepare(test::cast_room({}, 90));
  EXPECT_THROW(other.match(reference, test::cast_room({}, 90)), std::invalid_argument);
}

TEST(ScanMatcher, AnOptionOutOfBoundsIsNamed) {
  MatchOptions options;
  options.icp.trim = 0.0;
  try {
    ScanMatcher matcher(options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("icp.trim"), std::string::npos);
  }
}

}  // namespace
}  // namespace phasescan
