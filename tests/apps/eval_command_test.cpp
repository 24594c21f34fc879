// eval: nothing is not zero, and flags that mean nothing are refused. slam: what would be overwritten, what is old.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/temp.hpp"
#include "support/toy_log.hpp"

namespace phasescan::eval_command_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kPoses = "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n";

TEST(EvalCommand, WhatWasNotComparedHasNoNumber) {
  const TempFolder folder;
  const std::string poses = folder.put("t.tum", kPoses), far = folder.put("far.relations", "50 60 1 0 0 0 0 0\n");
  const std::vector<std::string> rpe{"eval", "--trajectory", poses, "--reference", poses, "--delta", "100"};
  EXPECT_THAT(run_command(rpe).out, HasSubstr("RPE            none (n = 0)\n"));
  std::vector<std::string> with_json = rpe;
  with_json.push_back("--json");
  EXPECT_TRUE(json::parse(run_command(with_json).out).at("rpe_m").at("mean").is_null());
  const auto relations = run_command({"eval", "--trajectory", poses, "--relations", far});
  EXPECT_EQ(relations.code, 1);
  EXPECT_EQ(relations.out, "1 relations, none answered\n");
  const auto as_json = run_command({"eval", "--trajectory", poses, "--relations", far, "--json"});
  EXPECT_TRUE(json::parse(as_json.out).at("translation_m").at("mean").is_null());
}

TEST(EvalCommand, ReferenceGivesTranslationAndRotationAsOneObject) {
  const TempFolder folder;
  const std::string poses = folder.put("t.tum", kPoses);
  const std::string turned = folder.put("r.tum", "0 0 0 0 0 0 0.0871557 0.9961947\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  const json j =
      json::parse(run_command({"eval", "--trajectory", poses, "--reference", turned, "--no-align", "--json"}).out);
  EXPECT_NEAR(j.at("translation_m").at("max"), 0.0, 1e-6);
  EXPECT_NEAR(j.at("rotation_deg").at("max"), 10.0, 1e-3);
  EXPECT_NEAR(j.at("rotation_deg").at("mean"), 10.0 / 3.0, 1e-3);
}

TEST(EvalCommand, AStepThatMeansNothingIsRefused) {
  const TempFolder folder;
  const std::string poses = folder.put("t.tum", kPoses), r = folder.put("r.relations", "0 1 1 0 0 0 0 0\n");
  const auto half = run_command({"eval", "--trajectory", poses, "--reference", poses, "--delta", "1.5"});
  EXPECT_EQ(half.code, 2);
  EXPECT_THAT(half.err, HasSubstr("--delta: 1.5 frames; expected a whole number"));
  EXPECT_EQ(
      run_command({"eval", "--trajectory", poses, "--reference", poses, "--delta", "1.5", "--delta-unit", "m"}).code,
      0);
  EXPECT_EQ(run_command({"eval", "--trajectory", poses, "--relations", r, "--delta", "2"}).code, 2);
  EXPECT_EQ(run_command({"eval", "--trajectory", poses, "--relations", r, "--no-align"}).code, 2);
}

TEST(EvalCommand, ClosureTellsOfDamageAndTakesATopicOfRosLogsAlone) {
  const TempFolder folder;
  const testing::ToyLog log = testing::toy_log(1000);
  const std::string truth = folder.put("truth.tum", log.truth);
  const std::string damaged = folder.put("tour.log", log.flaser + "FLASER cut\n");
  const auto run = run_command({"eval", "--trajectory", truth, "--closure", damaged});
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("tour.log:" + std::to_string(log.scans + 1) + ": "));
  const auto topic = run_command({"eval", "--trajectory", truth, "--closure", damaged, "--topic", "/scan"});
  EXPECT_EQ(topic.code, 2);
  EXPECT_THAT(topic.err, HasSubstr("has no topics"));
}

TEST(SlamCommand, ARecordingNeverTakesThePlaceOfTheLogOrOfAResult) {
  const TempFolder folder;
  const std::string text = testing::toy_log(20).flaser, log = folder.put("drive.log", text), out = folder / "out";
  for (const std::string& mcap : {log, folder.path() + "/./drive.log"}) {
    const auto run = run_command({"slam", log, "--out", out, "--mcap", mcap});
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("is the log itself"));
    EXPECT_EQ(slurp(log), text);
  }
  const auto run = run_command({"slam", log, "--out", out, "--mcap", out + "/map.png"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("is a file of --out"));
  EXPECT_EQ(run_command({"slam", log, "--out", out, "--mcap", out + "/drive.mcap"}).code, 0);
}

TEST(SlamCommand, AnEmptyLogSaysThatTheResultsAreOlder) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(20).flaser), out = folder / "out";
  const std::string empty = folder.put("empty.log", "PARAM robot_frontlaser_offset 0.0 nohost 0\n");
  EXPECT_THAT(run_command({"slam", empty, "--out", out}).err, Not(HasSubstr("earlier run")));
  ASSERT_EQ(run_command({"slam", log, "--out", out}).code, 0);
  const auto run = run_command({"slam", empty, "--out", out});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr(out + " holds the results of an earlier run"));
}

TEST(ScanLog, AScanWhoseOdometryCannotBeReadIsUsedWithoutIt) {
  const TempFolder folder;
  const std::string scan =
      R"({"angle_min": 0, "angle_increment": 0.1, "range_max": 6, "stamp": 1, "ranges": [1, 2, 3]})";
  std::string bad = scan;
  bad.insert(bad.size() - 1, R"(, "odometry": {"x": 1, "y": "two", "theta": 0})");
  for (const std::string& text : {bad + "\n", "[" + bad + "]\n"}) {
    const auto run = run_command({"info", folder.put("log", text), "--json", "--no-doctor"});
    EXPECT_EQ(run.code, 4) << run.err;
    EXPECT_EQ(json::parse(run.out).at("scans"), 1);
    EXPECT_EQ(json::parse(run.out).at("damages").at("bad odometry"), 1);
    EXPECT_THAT(run.err, HasSubstr("; the scan is used without it"));
  }
}

}  // namespace
}  // namespace phasescan::eval_command_test
