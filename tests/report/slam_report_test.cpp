#include "report/slam_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace phasescan {
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
    map_.width = map_.height = 20;
    map_.resolution_m = 0.5;
    map_.cells.assign(400, CellState::kFree);
    for (int i = 0; i < 9; ++i) way_.push_back({1.0 * i, 5.0, 0.0});
    for (int k = 0; k < 4; ++k) graph_.add_node({2.0 * k, 5.0, 0.0});
    for (const auto& [from, to] : {std::pair{0, 1}, {2, 3}}) {
      PoseEdge loop;
      loop.from = from;
      loop.to = to;
      loop.robust = true;
      graph_.add_edge(loop);
    }
    report_.map = &map_;
    report_.graph = &graph_;
    report_.trajectory = report_.odometry = way_;
  }
  TrinaryMap map_;
  std::vector<Pose2> way_;
  PoseGraph graph_;
  SlamReport report_;
};

TEST_F(SlamReportTest, OneWayWhereAllIsOnTheMap) {
  const std::string html = format_slam_report(report_);
  const std::array<char, 9> all = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  const std::array<char, 4> nodes = {1, 1, 1, 1};
  report_.on_map = all;
  report_.node_on_map = nodes;
  EXPECT_EQ(format_slam_report(report_), html);
  EXPECT_THAT(html, Not(HasSubstr("stroke-dasharray=\"5 4\"")));
  EXPECT_THAT(html, Not(HasSubstr("Dashed")));
  EXPECT_EQ(count_of(html, "stroke-width=\"1.5\" points="), 1u);
}

TEST_F(SlamReportTest, WhatIsOnNoPartOfTheMapIsDashedAndHasNoLoops) {
  const std::array<char, 9> on = {1, 1, 1, 0, 0, 0, 1, 1, 1};
  const std::array<char, 4> nodes = {1, 1, 0, 1};
  const std::size_t links = count_of(format_slam_report(report_), "stroke-opacity=\"0.6\"");
  report_.on_map = on;
  report_.node_on_map = nodes;
  const std::string html = format_slam_report(report_);
  EXPECT_EQ(count_of(html, "stroke-width=\"1.5\" points="), 2u);
  EXPECT_EQ(count_of(html, "stroke-dasharray=\"5 4\""), 1u);
  EXPECT_THAT(html, HasSubstr("Dashed: 3 scans"));
  EXPECT_EQ(links, 2u);
  EXPECT_EQ(count_of(html, "stroke-opacity=\"0.6\""), 1u);
}

}  // namespace
}  // namespace phasescan
