// The localize command from outside: whole runs, its files, bad maps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/tum.hpp"
#include "output/map_file.hpp"
#include "support/command.hpp"
#include "support/toy_log.hpp"
#include "support/toy_map.hpp"

namespace phasescan::localize_command_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;

/// A folder with a map of the toy world and a drive in it.
struct Place {
  TempFolder folder;
  testing::ToyLog log = testing::toy_log(120);
  Place() {
    const TrinaryMap map = testing::toy_map(testing::two_rooms(), {0, 0}, 0.05, 0.3);
    folder.put("map.pgm", format_pgm(map));
    folder.put("map.yaml", format_map_yaml(map, "map.pgm"));
    folder.put("toy.log", log.flaser);
  }
  test::CommandResult run(std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"localize",         "--map", folder / "map.yaml",
                                      folder / "toy.log", "--out", folder / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  json summary() const { return json::parse(slurp(folder / "out/summary.json")); }
  std::vector<json> lines() const {
    std::vector<json> out;
    for (const std::string& line : testing::lines_of(slurp(folder / "out/localization.jsonl")))
      out.push_back(json::parse(line));
    return out;
  }
};

TEST(LocalizeCommand, AWholeRunFollowsTheDriveOnTheMap) {
  const Place place;
  const auto run = place.run();
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const std::vector<json> lines = place.lines();
  ASSERT_EQ(lines.size(), place.log.scans);
  place.folder.put("truth.tum", place.log.truth);
  const auto truth = read_tum(place.folder / "truth.tum");
  std::size_t ok = 0, with_pose = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const json& line = lines[i];
    for (const char* key : {"stamp", "status", "pose", "covariance", "confidence", "hypotheses"})
      ASSERT_TRUE(line.contains(key)) << key;
    with_pose += line["status"] == "ok" || line["status"] == "degraded";
    if (line["status"] != "ok") continue;
    ++ok;
    EXPECT_LT(std::hypot(line["pose"]["x"].get<double>() - truth[i].pose.x,
                         line["pose"]["y"].get<double>() - truth[i].pose.y),
              0.1);
    EXPECT_EQ(line["covariance"].size(), 9U);
    EXPECT_GT(line["confidence"], 0.95);
    EXPECT_EQ(line["hypotheses"][0]["pose"], line["pose"]);
  }
  EXPECT_GT(ok, place.log.scans * 8 / 10);
  EXPECT_EQ(read_tum(place.folder / "out/trajectory.tum").size(), with_pose);
  const json summary = place.summary();
  EXPECT_EQ(summary["scans"], place.log.scans);
  EXPECT_EQ(summary["statuses"]["ok"], ok);
  EXPECT_THAT(summary["verdict"].get<std::string>(), ::testing::AnyOf("good", "doubtful"));
  EXPECT_THAT(slurp(place.folder / "out/report.html"), HasSubstr("</html>"));
}

TEST(LocalizeCommand, EachScanByItselfHasItsTimeAndTheSameBytesWithoutTimes) {
  const Place place;
  EXPECT_EQ(place.run({"--each"}).code, 0);
  EXPECT_GT(place.lines()[0]["ms"], 0.0);
  EXPECT_GT(place.summary()["map"]["preparation_ms"], 0.0);
  std::vector<std::string> bytes;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(place.run({"--each", "--no-times", "--threads", i == 0 ? "1" : "2"}).code, 0);
    std::string all;
    for (const char* file : {"localization.jsonl", "summary.json", "report.html", "trajectory.tum"})
      all += slurp(place.folder / ("out/" + std::string(file)));
    bytes.push_back(all);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_FALSE(place.lines()[0].contains("ms"));
}

/// The first `count` scans of a CARMEN log become those of a round room that is on no map.
std::string begun_elsewhere(const std::string& log, std::size_t count) {
  std::string out;
  std::size_t n = 0;
  for (const std::string& line : testing::lines_of(log)) {
    std::istringstream words(line);
    std::string word;
    const bool elsewhere = line.starts_with("FLASER") && n++ < count;
    for (std::size_t k = 0, beams = 0; words >> word; ++k) {
      if (elsewhere && k == 1) beams = std::stoul(word);
      out += (k == 0 ? "" : " ") + (elsewhere && k > 1 && k < 2 + beams ? "0.7" + std::to_string(k % 3) : word);
    }
    out += '\n';
  }
  return out;
}

/// With --each and without, what comes before the first scan that is ok does not count.
TEST(LocalizeCommand, TheVerdictIsOfWhatComesAfterTheFirstScanThatIsOk) {
  const Place place;
  place.folder.put("toy.log", begun_elsewhere(place.log.flaser, 40));
  for (const std::vector<std::string>& flags : {std::vector<std::string>{}, {"--each"}}) {
    ASSERT_EQ(place.run(flags).code, 0);
    double with_pose = 0, after = 0, sum = 0;
    std::size_t before = 0;
    for (const json& line : place.lines()) {
      if (after == 0 && line["status"] != "ok") {
        ++before;
        continue;
      }
      ++after;
      if (line["status"] != "ok" && line["status"] != "degraded") continue;
      ++with_pose;
      sum += line["confidence"].get<double>();
    }
    ASSERT_GE(before, 40U);
    const json summary = place.summary();
    EXPECT_NEAR(summary["verdict_probability"].get<double>(), sum / after, 1e-4);
    EXPECT_EQ(summary["verdict"], with_pose / after >= 0.9 && sum / after >= 0.95 ? "good" : "doubtful");
  }
}

TEST(LocalizeCommand, AGivenPoseIsTaken) {
  const Place place;
  EXPECT_EQ(place.run({"--initial", "0.1,-0.1,3"}).code, 0);
  const json first = place.lines()[0]["pose"];
  EXPECT_LT(std::hypot(first["x"].get<double>(), first["y"].get<double>()), 0.1);
  EXPECT_EQ(place.run({"--initial", "0.1,0"}).code, 2);
  EXPECT_EQ(place.run({"--initial", "0,0,0", "--each"}).code, 2);
}

/// What is known of the sensor makes the heading less sure, by how much its whole revolutions turn.
TEST(LocalizeCommand, ASensorWhoseRevolutionsTurnWidensTheHeading) {
  const Place place;
  ASSERT_EQ(place.run().code, 0);
  const std::vector<json> plain = place.lines();
  place.folder.put("turning.yaml", "beams: 450\nrevolution_turn_deg: 0.5\n");
  for (const std::vector<std::string>& flags : {std::vector<std::string>{}, {"--each"}}) {
    std::vector<std::string> with = flags;
    with.insert(with.end(), {"--sensor", place.folder / "turning.yaml"});
    ASSERT_EQ(place.run(flags).code, 0);
    const std::vector<json> without = place.lines();
    const auto run = place.run(with);
    ASSERT_EQ(run.code, 0) << run.err;
    const std::vector<json> widened = place.lines();
    const double turn = deg_to_rad(0.5), was = without[5]["covariance"][8].get<double>();
    EXPECT_NEAR(widened[5]["covariance"][8].get<double>(), was + turn * turn, 1e-9);
    EXPECT_EQ(widened[5]["pose"], without[5]["pose"]);
    EXPECT_EQ(widened[5]["confidence"], without[5]["confidence"]);
  }
  EXPECT_EQ(place.run({"--sensor", "ld06-real"}).code, 0);
  EXPECT_GT(place.lines()[5]["covariance"][8], plain[5]["covariance"][8]);
  const auto unknown = place.run({"--sensor", "no-such-sensor"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("no-such-sensor"));
}

TEST(LocalizeCommand, ASavedRunIsAMapToo) {
  const Place place;
  const std::string state = place.folder / "toy.state";
  ASSERT_EQ(run_command({"slam", place.folder / "toy.log", "--out", place.folder / "slam", "--save", state}).code, 0);
  const auto run = run_command({"localize", "--state", state, place.folder / "toy.log", "--out", place.folder / "out"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_GT(place.summary()["statuses"]["ok"], 90);
  const auto mistaken =
      run_command({"localize", "--map", state, place.folder / "toy.log", "--out", place.folder / "no"});
  EXPECT_EQ(mistaken.code, 2);
  EXPECT_THAT(mistaken.err, HasSubstr("is a saved run; expected a map_server yaml"));
  EXPECT_EQ(run_command({"localize", "--state", place.folder / "toy.log", place.folder / "toy.log", "--out",
                         place.folder / "no"})
                .code,
            2);
}

TEST(LocalizeCommand, AnotherPlaceIsNotFoundAndTheFilesAreWrittenAllTheSame) {
  const Place place;
  const TrinaryMap map = testing::toy_map(testing::corridor_with_niches(20, 0.6), {1, 0});
  place.folder.put("map.pgm", format_pgm(map));
  place.folder.put("map.yaml", format_map_yaml(map, "map.pgm"));
  const auto run = place.run({"--each"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("not localised"));
  EXPECT_EQ(place.summary()["verdict"], "failed");
}

/// One line, exit 2, and nothing is left behind.
TEST(LocalizeCommand, BadMapsAreRefusedInOneLine) {
  const Place place;
  const TrinaryMap good = testing::toy_map(testing::two_rooms(), {0, 0});
  const std::string tail = "origin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  const std::string plain = "image: m.pgm\nresolution: 0.05\n" + tail;
  const auto picture = [&](CellState all) {
    TrinaryMap map = good;
    std::fill(map.cells.begin(), map.cells.end(), all);
    return format_pgm(map);
  };
  struct Case {
    const char* what;
    std::string image, yaml, expected;
  };
  const std::string pgm = format_pgm(good);
  for (
      const Case& c : {
          Case{"missing image", "", "image: none.pgm\nresolution: 0.05\n" + tail, "none.pgm"},
          Case{"wrong size", pgm.substr(0, pgm.size() / 2), plain, "fewer than its"},
          Case{"all unknown", picture(CellState::kUnknown), plain, "no free space"},
          Case{"all occupied", picture(CellState::kOccupied), plain, "no free space"},
          Case{"all free", picture(CellState::kFree), plain, "no occupied cell"},
          Case{"one pixel", "P5\n1 1\n255\n\376", plain, "no occupied cell"},
          Case{"30,000 x 30,000", "P5\n30000 30000\n255\n", plain, "30000 x 30000"},
          Case{"resolution 0", pgm, "image: m.pgm\nresolution: 0\n" + tail, "resolution"},
          Case{"resolution below 0", pgm, "image: m.pgm\nresolution: -0.05\n" + tail, "resolution"},
          Case{
              "origin NaN", pgm,
              "image: m.pgm\nresolution: 0.05\norigin: [0, 0, .nan]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
              "origin"},
          Case{"yaml of another tool", pgm, "Panels:\n  - Class: rviz/Displays\n", "map_server"},
          Case{"no yaml", pgm, "P5 is not yaml: [", "m.yaml"},
      }) {
    std::filesystem::remove(place.folder / "m.pgm");
    if (!c.image.empty()) place.folder.put("m.pgm", c.image);
    place.folder.put("m.yaml", c.yaml);
    const auto run = run_command(
        {"localize", "--map", place.folder / "m.yaml", place.folder / "toy.log", "--out", place.folder / "bad"});
    EXPECT_EQ(run.code, 2) << c.what << ": " << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << c.what << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr(c.expected)) << c.what;
    EXPECT_FALSE(std::filesystem::exists(place.folder / "bad")) << c.what;
  }
  EXPECT_EQ(run_command({"localize", place.folder / "toy.log", "--out", place.folder / "bad"}).code, 2);
}

// All scans are from a room that was wiped from the map: there is no median of what was right.
TEST(BenchLocalize, WhatNothingWasRightOfIsStillJson) {
  const auto run =
      run_command({"bench", "localize", "--worlds", "flat:5", "--poses", "2", "--unmapped", "1", "--seed", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto line = nlohmann::json::parse(run.out);
  EXPECT_EQ(line["right"], 0);
  EXPECT_TRUE(line["median_m"].is_null());
  EXPECT_TRUE(line["median_deg"].is_null());
}

TEST(BenchLocalize, DrawsTheConfidenceOfEveryAnswerThatIsNotAmbiguous) {
  const test::TempFolder folder;
  const auto run = run_command({"bench", "localize", "--worlds", "flat:5", "--poses", "12", "--seed", "1", "--no-times",
                                "--figure", folder / "curve.svg"});
  ASSERT_EQ(run.code, 0) << run.err;
  const auto line = nlohmann::json::parse(run.out);
  std::size_t answers = 0;
  for (const auto& bin : line["reliability"]) answers += bin[2].get<std::size_t>();
  ASSERT_GT(answers, 0U);
  const std::string svg = slurp(folder / "curve.svg");
  EXPECT_THAT(svg, HasSubstr(std::to_string(answers) + " answers, calibration error"));
  const auto bad = run_command(
      {"bench", "localize", "--worlds", "flat:5", "--poses", "1", "--figure", folder / "nowhere/curve.svg"});
  EXPECT_NE(bad.code, 0);
  EXPECT_THAT(bad.err, HasSubstr("nowhere"));
}

}  // namespace
}  // namespace phasescan::localize_command_test
