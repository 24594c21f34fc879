#include "report/slam_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace phasescan::slam_report_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

class SlamReportTest : public ::testing::Test {
 protected:
  SlamReportTest() {
    result_.map.width = result_.map.height = 20;
    result_.map.resolution_m = 0.5;
    result_.map.cells.assign(400, CellState::kFree);
    for (int i = 0; i < 9; ++i) {
      ScanResult scan;
      scan.T_map_base = scan.T_odom_base = {1.0 * i, 5.0, 0.0};
      result_.scans.push_back(scan);
    }
    for (int k = 0; k < 4; ++k) {
      MapKeyframe keyframe;
      keyframe.T_map_base = {2.0 * k, 5.0, 0.0};
      result_.keyframes.push_back(keyframe);
    }
    result_.drawn.assign(4, 1);
    for (const auto& [from, to] : {std::pair{0, 1}, {2, 3}}) {
      MapEdge loop;
      loop.from = from;
      loop.to = to;
      loop.loop = true;
      result_.edges.push_back(loop);
    }
    report_.result = &result_;
  }
  std::string html() const { return format_slam_report(report_); }
  std::size_t links() const { return count_of(html(), "stroke-opacity=\"0.6\""); }

  SlamResult result_;
  SlamReport report_;
};

TEST_F(SlamReportTest, OneWayWhereAllIsOnTheMap) {
  EXPECT_THAT(html(), Not(HasSubstr("stroke-dasharray=\"5 4\"")));
  EXPECT_THAT(html(), Not(HasSubstr("Dashed")));
  EXPECT_EQ(count_of(html(), "stroke-width=\"1.5\" points="), 1u);
  EXPECT_EQ(links(), 2u);
}

TEST_F(SlamReportTest, WhatIsOnNoPartOfTheMapIsDashedAndHasNoLoops) {
  for (const std::size_t i : {3u, 4u, 5u}) result_.scans[i].on_map = false;
  result_.drawn[2] = 0;
  EXPECT_EQ(count_of(html(), "stroke-width=\"1.5\" points="), 2u);
  EXPECT_EQ(count_of(html(), "stroke-dasharray=\"5 4\""), 1u);
  EXPECT_THAT(html(), HasSubstr("Dashed: 3 scans"));
  EXPECT_EQ(links(), 1u);
}

TEST_F(SlamReportTest, LoopsThatWereTakenOutAreDrawnApartAndStepsAreNoLoops) {
  result_.edges[1].enabled = false;
  MapEdge step;
  step.from = 1;
  step.to = 2;
  result_.edges.push_back(step);
  const std::string text = html();
  EXPECT_EQ(links(), 2u);
  result_.edges[1].enabled = true;
  EXPECT_NE(html(), text);
}

TEST_F(SlamReportTest, AStoppedRunSaysSo) {
  EXPECT_THAT(html(), Not(HasSubstr("Stopped before the end of the log")));
  report_.complete = false;
  EXPECT_THAT(html(), HasSubstr("Stopped before the end of the log: all of this is of its first 9 scans."));
}

TEST_F(SlamReportTest, AVerdictStandsOnTopWithItsReasonsOnTheMap) {
  EXPECT_THAT(html(), Not(HasSubstr("Verdict")));
  report_.verdict = "doubtful: walls stand twice";
  report_.reasons.push_back({"doubled_walls", 2, 0, "two walls 0.3 m apart", 2.5, 5.0});
  report_.reasons.push_back({"gaps", 1, 0, "no scan for 12 s", {}, {}});
  EXPECT_THAT(html(), HasSubstr("doubtful: walls stand twice"));
  EXPECT_THAT(html(), HasSubstr("2. gaps: no scan for 12 s"));
  EXPECT_EQ(count_of(html(), "<circle "), 1u);
}

}  // namespace
}  // namespace phasescan::slam_report_test
