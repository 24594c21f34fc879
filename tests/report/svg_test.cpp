#include "report/svg.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/random.hpp"
#include "report/chart.hpp"
#include "report/scan_plot.hpp"
#include "support/xml_check.hpp"

namespace phasescan::svg_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Scan round_room(int beams, double radius) {
  std::vector<float> ranges(static_cast<std::size_t>(beams), static_cast<float>(radius));
  return make_scan(ranges, {-kPi, kTwoPi / beams, 0.1, 10.0});
}

TEST(Svg, TextIsEscapedAndTheDocumentIsWellFormed) {
  SvgCanvas canvas(100, 50);
  canvas.text(3, 4, "a < b & \"c\" > d\x01", {11, TextAnchor::kEnd, "#000", true, 90});
  canvas.marker(1, 1, Marker::kDiamond, 5, "#123456");
  const std::string svg = canvas.str("t & u");
  EXPECT_EQ(xml_error(svg), "");
  EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot; &gt; d<"), std::string::npos);
}

TEST(Svg, NotFiniteCoordinatesBreakLinesAndLeaveOutPoints) {
  SvgCanvas canvas(100, 100);
  const std::vector<double> x{0, 1, kNan, 3, 4}, y{0, 1, 2, 3, std::numeric_limits<double>::infinity()};
  canvas.polyline(x, y, {});
  canvas.dots(x, y, 2, "#000");
  canvas.marker(kNan, 1, Marker::kCircle, 4, "#000");
  const std::string svg = canvas.str();
  EXPECT_NE(svg.find("M0 0L1 1M3 3\""), std::string::npos);
  EXPECT_NE(svg.find("M0 0h0M1 1h0M3 3h0\""), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(Svg, RejectsASizeThatIsNone) {
  EXPECT_THROW(SvgCanvas(0, 10), std::invalid_argument);
  EXPECT_THROW(SvgCanvas(10, kNan), std::invalid_argument);
}

TEST(Svg, PixelsAreJoinedIntoRuns) {
  SvgCanvas canvas(40, 10);
  const std::vector<float> row{0, 1, 1, 0};
  canvas.pixels(0, 0, 40, 10, row, 1, 4, "#000");
  EXPECT_NE(canvas.str().find("M10 0h20v10h-20z\""), std::string::npos);
  EXPECT_THROW(canvas.pixels(0, 0, 1, 1, row, 2, 4, "#000"), std::invalid_argument);
}

TEST(Svg, NumbersAreShort) {
  EXPECT_EQ(plain_number(0.5, 3), "0.5");
  EXPECT_EQ(plain_number(-0.0001, 2), "0");
  EXPECT_EQ(plain_number(120.0, 2), "120");
  EXPECT_EQ(plain_number(100.0, 0), "100");
}

TEST(Chart, TicksAreRoundNumbersInsideTheLimits) {
  const std::vector<double> ticks = nice_ticks(0.0, 1.0, 5);
  ASSERT_EQ(ticks.size(), 6u);
  EXPECT_DOUBLE_EQ(ticks[1], 0.2);
  for (const auto& [low, high] : {std::pair{-3.7, 12.2}, {1e-6, 3e-6}, {-1e7, 1e7}, {99.1, 99.4}}) {
    const std::vector<double> t = nice_ticks(low, high, 6);
    EXPECT_GE(t.size(), 3u);
    EXPECT_LE(t.size(), 13u);
    EXPECT_GE(t.front(), low - 1e-9 * (high - low));
    EXPECT_LE(t.back(), high + 1e-9 * (high - low));
  }
}

TEST(Chart, EveryKindOfSeriesIsWellFormedAlsoWithNothingInIt) {
  for (const SeriesKind kind : {SeriesKind::kLine, SeriesKind::kPoints, SeriesKind::kDots, SeriesKind::kBars,
                                SeriesKind::kBoxes, SeriesKind::kBand}) {
    for (const bool filled : {false, true}) {
      Chart chart;
      chart.title = "A <title>";
      chart.x.label = "x";
      chart.y.label = "y";
      Series s;
      s.kind = kind;
      s.name = "one & two";
      s.marker = Marker::kSquare;
      if (filled) {
        s.x = {0, 1, 2};
        s.y = {3, kNan, 5};
        s.low = {2, 2, kNan};
        s.high = {4, 5, 6};
        s.q1 = {2.5, 2.5, 4};
        s.q3 = {3.5, 4, 5.5};
      }
      chart.series = {s, s};
      const std::string svg = chart.svg();
      EXPECT_EQ(xml_error(svg), "");
      EXPECT_EQ(svg.find("nan"), std::string::npos);
      chart.x.categories = {"small", "middle", "a very long name of a class that has to be slanted"};
      EXPECT_EQ(xml_error(chart.svg()), "");
    }
  }
}

TEST(Chart, LengthsThatDifferAreTheCallersMistake) {
  Chart chart;
  Series s;
  s.name = "short";
  s.x = {1, 2};
  s.y = {1};
  chart.series = {s};
  EXPECT_THROW(chart.svg(), std::invalid_argument);
}

TEST(Chart, TheSameChartGivesTheSameBytes) {
  Random random(7);
  Chart chart;
  Series s;
  for (int i = 0; i < 50; ++i) {
    s.x.push_back(random.uniform(-1, 1));
    s.y.push_back(random.uniform(-100, 100));
  }
  chart.series = {s};
  EXPECT_EQ(chart.svg(), chart.svg());
}

TEST(ScanPlot, DrawsAnyResult) {
  const Scan room = round_room(90, 2.0), empty = make_scan({}, {});
  MatchResult result;
  result.T_ref_scan = {0.4, -0.1, 0.3};
  result.confidence = 0.5;
  result.alternatives = {{{1, 2, 3}, 0.25}, {{0, 0, 1}, 0.125}, {{0, 0, 2}, 0.1}};
  const std::string svg = scan_pair_svg(room, room, result, Pose2{0.5, -0.1, 0.3});
  EXPECT_EQ(xml_error(svg), "");
  EXPECT_NE(svg.find("not usable, no points"), std::string::npos);
  EXPECT_NE(svg.find("error 0.100 m, 0.00 deg"), std::string::npos);
  EXPECT_NE(svg.find("Alternative 2"), std::string::npos);
  EXPECT_NE(svg.find("confidence 0.125"), std::string::npos);
  EXPECT_EQ(xml_error(scan_pair_svg(empty, empty, {})), "");
}

}  // namespace
}  // namespace phasescan::svg_test
