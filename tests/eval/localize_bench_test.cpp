// Localisation measured: maps and scans with their truth, both searches compared, drives.
#include "eval/localize_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "eval/localize_places_file.hpp"
#include "eval/localize_runs.hpp"
#include "eval/localize_yardstick.hpp"
#include "phasescan/io/scan_json.hpp"
#include "support/temp.hpp"

namespace phasescan {
namespace {

SimulatedPlacesSpec small_flat() {
  SimulatedPlacesSpec spec;
  spec.worlds = {"flat:3"};
  spec.poses = 12;
  spec.unmapped = 0.25;
  spec.people = 2;
  spec.moved = 0.3;
  return spec;
}

TEST(LocalizePlaces, SomeScansAreFromRoomsThatTheMapHasNot) {
  const LocalizePlaces places = simulated_places(small_flat(), [] {});
  ASSERT_EQ(places.cases.size(), 12U);
  const auto off_map = std::count_if(places.cases.begin(), places.cases.end(), [](const auto& c) { return !c.mapped; });
  EXPECT_EQ(off_map, 3);
  for (const LocalizeCase& one : places.cases) {
    const Eigen::Vector2d p = places.map.origin.inverse() * one.T_map_base.translation() / places.map.resolution_m;
    const auto i = static_cast<int>(p.x()), k = static_cast<int>(p.y());
    const bool inside = i >= 0 && k >= 0 && i < places.map.width && k < places.map.height;
    EXPECT_EQ(one.mapped, inside && places.map.at(i, k) == CellState::kFree);
  }
}

TEST(LocalizePlaces, AreReadAsTheyWereWritten) {
  const LocalizePlaces places = simulated_places(small_flat(), [] {});
  const test::TempFolder folder;
  EXPECT_FALSE(has_places(folder / "kept"));
  write_places(folder / "kept", places);
  ASSERT_TRUE(has_places(folder / "kept"));
  const LocalizePlaces again = read_places(folder / "kept");
  EXPECT_EQ(again.name, places.name);
  EXPECT_EQ(again.map.cells, places.map.cells);
  ASSERT_EQ(again.cases.size(), places.cases.size());
  for (std::size_t i = 0; i < places.cases.size(); ++i) {
    EXPECT_EQ(again.cases[i].T_map_base.x, places.cases[i].T_map_base.x);
    EXPECT_EQ(again.cases[i].mapped, places.cases[i].mapped);
    Scan scan = places.cases[i].measurement.scan;  // stamps are given anew
    scan.stamp = again.cases[i].measurement.scan.stamp;
    EXPECT_EQ(format_scan_json(again.cases[i].measurement.scan), format_scan_json(scan));
  }
}

TEST(Yardstick, CountsWhatTheExhaustiveSearchKnowsAndWhatWasFoundOfIt) {
  std::vector<YardstickRow> yardstick(5);
  std::vector<LocalizeRow> ours(5);
  for (LocalizeRow& row : ours) row.update.T_map_base = Pose2{}, row.update.status = TrackingStatus::kOk;
  yardstick[0] = {true, true, true, false, true, -10.0, 1.0};  // clear, found
  yardstick[1] = {true, true, true, false, true, -10.0, 2.0};  // clear, ours is elsewhere and ok
  ours[1].error_m = 3.0, ours[1].update.fit.log_likelihood = -30.0;
  yardstick[2] = {true, true, true, true, false, -10.0, 3.0};  // ambiguous
  ours[2].update.status = TrackingStatus::kAmbiguous;
  yardstick[3] = {false, true, false, false, false, 0.0, 9.0};  // not on the map: counts for nothing
  yardstick[4] = {true, false, false, false, false, 0.0, 2.5};  // given up
  const YardstickScore s = compare(yardstick, ours, 6.0);
  EXPECT_EQ(s.unfinished, 1U);
  EXPECT_EQ(s.n, 3U);
  EXPECT_EQ(s.truth_among, 3U);
  EXPECT_EQ(s.ambiguous, 1U);
  EXPECT_EQ(s.our_ambiguous, 1U);
  EXPECT_EQ(s.clear, 2U);
  EXPECT_EQ(s.clear_our_right, 1U);
  EXPECT_EQ(s.clear_our_wrong_ok, 1U);
  EXPECT_EQ(s.missed, 1U);
  EXPECT_EQ(s.s_most, 3.0);
}

TEST(LocalizeRuns, AKidnappedRobotKnowsItsPlaceAgain) {
  LocalizeRunsSpec spec;
  spec.worlds = {"flat:3"};
  spec.kidnaps = 2;
  spec.kidnaps_per_m = 0.1;
  spec.starts_every_m = 5.0;
  const LocalizeRunsScore score = run_drives(spec, {}, [] {});
  const auto kidnapped =
      std::count_if(score.starts.begin(), score.starts.end(), [](const UnknownStart& s) { return s.kidnapped; });
  EXPECT_EQ(kidnapped, 2);
  EXPECT_GT(score.starts.size(), 3U);  // the first, and those of localizers that were begun on the way
  for (const UnknownStart& start : score.starts) {
    EXPECT_LT(start.noticed_s, 1.0);
    EXPECT_LT(start.wrong_ok_s, 1.0);
  }
  EXPECT_EQ(score.ok, score.right_ok + score.wrong_ok);
  EXPECT_EQ(score.errors_m.size(), score.ok);
  EXPECT_GE(score.judgements.size(), score.ok + score.degraded);
  EXPECT_GT(std::count_if(score.judgements.begin(), score.judgements.end(), [](const Judgement& j) { return j.right; }),
            static_cast<std::ptrdiff_t>(score.right_ok) - 1);
  EXPECT_LE(score.longest_wrong_ok_s, 1.0);
}

}  // namespace
}  // namespace phasescan
