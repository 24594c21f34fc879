#include "report/map_viewer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace phasescan::map_viewer_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Scan four_beams() {
  ScanGeometry geometry;
  geometry.angle_increment = kPi / 2.0;
  geometry.range_max = 10.0;
  return make_scan(std::vector<float>{1.0F, 2.0F, 0.0F, 3.0F}, geometry);
}

TEST(ShownScans, HitsAreKeptInTheFrameOfTheBase) {
  ShownScans shown;
  shown.add(0, four_beams(), {0.5, 0.0, kPi / 2.0});
  ASSERT_EQ(shown.scans().size(), 1u);
  EXPECT_EQ(shown.scans()[0].points_cm, (std::vector<std::int16_t>{50, 100, -150, 0, 350, 0}));
}

TEST(ShownScans, ALongRunIsThinnedEvenly) {
  ShownScans shown;
  for (std::size_t i = 0; i < 10'000; ++i) shown.add(i, four_beams(), {});
  EXPECT_LE(shown.scans().size(), ShownScans::kMost);
  EXPECT_GT(shown.scans().size(), ShownScans::kMost / 3);
  for (std::size_t k = 0; k < shown.scans().size(); ++k) EXPECT_EQ(shown.scans()[k].scan, k * shown.every());
}

TEST(MapViewer, LoadsNothingAndSaysWhatWasThinned) {
  SlamResult result;
  result.map.width = result.map.height = 4;
  result.map.resolution_m = 0.5;
  result.map.cells.assign(16, CellState::kFree);
  result.scans.resize(900);
  ShownScans shown;
  for (std::size_t i = 0; i < 900; ++i) shown.add(i, four_beams(), {});
  const std::string page = map_viewer(result, shown);
  EXPECT_THAT(page, HasSubstr("Every 4th scan is kept here."));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr(" src=")));
}

}  // namespace
}  // namespace phasescan::map_viewer_test
