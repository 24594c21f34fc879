#include "report/html.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "report/chart.hpp"
#include "support/xml_check.hpp"

namespace phasescan::html_test {
namespace {

TEST(Table, MarkdownEscapesBarsAndFillsShortRows) {
  const Table table{"Caption", {"method", "a", "b"}, {{"x|y", "1"}, {"z", "2", "3"}}, 1};
  EXPECT_EQ(table.markdown(), "Caption\n\n| method | a | b |\n|---|---:|---:|\n| x\\|y | 1 |  |\n| z | 2 | 3 |\n");
  EXPECT_EQ(xml_error(table.html()), "");
}

TEST(Table, NumbersThatAreNoneAreADash) {
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(fixed(-0.0001, 2), "0.00");
  EXPECT_EQ(fixed(-0.5, 1), "-0.5");
  EXPECT_EQ(percent(0.9733), "97.3");
}

TEST(HtmlReport, IsOneWellFormedPageThatLoadsNothing) {
  HtmlReport report("A & B", "<lead>");
  report.heading("First");
  report.paragraph("text with <angle> & \"quote\"");
  report.bullets({"one", "two < three"});
  Chart chart;
  chart.series.push_back({SeriesKind::kLine, "s", {0, 1}, {2, 3}});
  report.figure(chart.svg(), "caption & more");
  report.figures({chart.svg(), chart.svg()}, {"a", "b"});
  report.heading("Second");
  report.heading("Part", 3);
  report.table({"", {"h"}, {{"v"}}, 1});
  report.code("x < y");
  const std::string html = report.str();
  EXPECT_EQ(xml_error(html), "");
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("src="), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("url("), std::string::npos);
  EXPECT_NE(html.find("<a href=\"#s2\">Second</a>"), std::string::npos);
}

}  // namespace
}  // namespace phasescan::html_test
