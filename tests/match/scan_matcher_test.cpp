#include "phasescan/match/scan_matcher.hpp"

#include <gtest/gtest.h>

#include "support/rooms.hpp"

namespace phasescan::scan_matcher_test {
namespace {

TEST(ScanMatcher, APreparedReferenceGivesTheSameAnswer) {
  ScanMatcher matcher;
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
  const MatchOptions options;
  const auto one = match_many(reference, scans, options, 1), three = match_many(reference, scans, options, 3);
  ASSERT_EQ(one.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    EXPECT_EQ(one[i].T_ref_scan.x, three[i].T_ref_scan.x);
    EXPECT_EQ(one[i].T_ref_scan.theta, three[i].T_ref_scan.theta);
  }
}

TEST(ScanMatcher, AnOptionOutOfBoundsIsNamed) {
  MatchOptions options;
  options.global.finalists = 0;
  try {
    ScanMatcher matcher(options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("global.finalists"), std::string::npos);
  }
}

}  // namespace
}  // namespace phasescan::scan_matcher_test
