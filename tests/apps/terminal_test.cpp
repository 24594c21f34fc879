// What commands say to somebody at a terminal, and that nothing of it reaches a pipe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/temp.hpp"
#include "support/terminal.hpp"
#include "support/toy_log.hpp"

namespace phasescan::terminal_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::run_on_terminal;
using test::TempFolder;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Terminal, SlamEndsWithScansWayLoopsMapVerdictAndWhatToOpen) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(120).flaser), out = folder / "out";
  const auto shown = run_on_terminal({"slam", log, "--out", out}, {{"NO_COLOR", "1"}});
  EXPECT_EQ(shown.code, 0) << shown.out;
  EXPECT_THAT(shown.out,
              AllOf(HasSubstr("scans    120, all on the map"), ContainsRegex("way      [0-9.]+ m in [0-9]+ s"),
                    ContainsRegex("loops    [0-9]+"), ContainsRegex("map      [0-9.]+ m x [0-9.]+ m, cells of 5 cm"),
                    ContainsRegex("verdict  good"), HasSubstr("open     " + out + "/report.html")));
  EXPECT_THAT(shown.out, Not(HasSubstr("\033[2m")));
  EXPECT_EQ(run_command({"slam", log, "--out", out}).out, "");
}

TEST(Terminal, AMatchIsALineForPeopleUnlessJsonIsAskedFor) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(30).flaser);
  const std::vector<std::string> words{"match", log + "#0", log + "#4", "--no-times"};
  const auto shown = run_on_terminal(words);
  EXPECT_EQ(shown.code, 0) << shown.out;
  EXPECT_THAT(shown.out, ContainsRegex("\033.32musable\033.0m  x -?[0-9.]+ m, y -?[0-9.]+ m, -?[0-9.]+ deg  .1 sigma"));
  EXPECT_THAT(shown.out, HasSubstr("% sure"));
  const std::string piped = run_command(words).out;
  EXPECT_TRUE(json::parse(piped).at("usable").get<bool>());
  std::vector<std::string> with_json = words;
  with_json.push_back("--json");
  EXPECT_EQ(run_command(with_json).out, piped);
  EXPECT_TRUE(json::parse(run_on_terminal(with_json).out).at("usable").get<bool>());
}

TEST(Terminal, NoColourWhereNoneIsWantedOrKnown) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(30).flaser);
  for (const auto& [name, value] : {std::pair{"NO_COLOR", "1"}, std::pair{"TERM", "dumb"}}) {
    EXPECT_THAT(run_on_terminal({"match", log + "#0", log + "#4"}, {{name, value}}).out, Not(HasSubstr("\033[3")))
        << name;
  }
  const std::string gap = folder.put("gap.log", testing::toy_log(30).flaser + "FLASER cut\n");
  EXPECT_THAT(run_on_terminal({"info", gap}).out, HasSubstr("\033[33m\033[1mwarning\033["));
  EXPECT_THAT(run_on_terminal({"info", gap}, {{"NO_COLOR", "1"}}).out, HasSubstr("phasescan: warning: "));
}

TEST(Terminal, ConvertBenchAndPairsNameWhatTheyMade) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(30).flaser), pairs = folder / "pairs.jsonl";
  const std::pair<std::string, std::string> plain{"NO_COLOR", "1"};
  EXPECT_THAT(
      run_on_terminal({"convert", log, folder / "drive.mcap"}, {plain}).out,
      AllOf(ContainsRegex("scans  30 in [0-9]+ s"), HasSubstr("wrote  " + folder.path() + "/drive.mcap (mcap)")));
  ASSERT_EQ(run_command({"simulate", "--world", "flat", "--pairs", "2", "--out", pairs}).code, 0);
  EXPECT_THAT(run_on_terminal({"match", "--pairs", pairs}, {plain}).out, HasSubstr("flat-000001  usable  x "));
  const std::string out = folder / "bench";
  EXPECT_THAT(run_on_terminal({"bench", "--pairs", pairs, "--method", "global", "--out", out}, {plain}).out,
              AllOf(ContainsRegex("pairs   2\r\nglobal  2 of 2 right .100.0 %., 0 wrong and called usable"),
                    HasSubstr("open    " + out + "/results.md")));
}

TEST(Terminal, SimulateNamesTheLogItsTruthOrThePairs) {
  const TempFolder folder;
  const std::pair<std::string, std::string> plain{"NO_COLOR", "1"};
  const std::string log = folder / "drive.jsonl", pairs = folder / "pairs.jsonl";
  const std::vector<std::string> words{"simulate", "--world", "flat:3", "--duration", "3", "--out", log};
  EXPECT_THAT(run_on_terminal(words, {plain}).out,
              AllOf(ContainsRegex("scans  [0-9]+ in 3 s"), HasSubstr("wrote  " + log + ", " + log + ".truth.tum")));
  EXPECT_EQ(run_command(words).out, "");
  EXPECT_THAT(run_on_terminal({"simulate", "--world", "flat", "--pairs", "2", "--out", pairs}, {plain}).out,
              HasSubstr("pairs  2\r\nwrote  " + pairs));
}

TEST(Terminal, ProgressOfALogKnowsItsLengthUnlessItIsAPipe) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(200).flaser);
  EXPECT_THAT(run_on_terminal({"slam", log, "--out", folder / "out"}).out, ContainsRegex("slam .[# ]+. +[0-9]+ %"));
  EXPECT_THAT(run_command({"slam", log, "--out", folder / "out"}).err, Not(HasSubstr("%")));
}

TEST(Json, InfoIsOneObject) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(30).flaser + "FLASER cut\n");
  const auto run = run_command({"info", log, "--json"});
  EXPECT_EQ(run.code, 4) << run.err;
  const json info = json::parse(run.out);
  EXPECT_EQ(info.at("scans"), 30);
  EXPECT_EQ(info.at("format"), "carmen");
  EXPECT_EQ(info.at("damaged_places"), 1);
  EXPECT_TRUE(info.at("findings").is_array());
  EXPECT_GT(info.at("duration_s"), 0.0);
}

TEST(Words, TheNearestOneIsNamed) {
  const TempFolder folder;
  const std::string log = folder.put("drive.log", testing::toy_log(3).flaser), out = folder / "out";
  const auto expect = [](const std::vector<std::string>& words, const std::string& near) {
    const auto run = run_command(words);
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("; did you mean '" + near + "'?"));
  };
  expect({"slma", log}, "slam");
  expect({"bench", "retreival"}, "retrieval");
  expect({"slam", log, "--out", out, "--thread", "2"}, "--threads");
  expect({"slam", log, "--out", out, "--odometry", "non"}, "none");
  expect({"match", log + "#0", log + "#1", "--method", "glob"}, "global");
  expect({"bench", "--pairs", log, "--out", out, "--method", "icp,nbt"}, "ndt");
  expect({"simulate", "--world", "offce", "--out", out}, "office");
  expect({"simulate", "--sensor", "rplidar-a11", "--out", out}, "rplidar-a1");
  expect({"simulate", "--path", "tuor", "--out", out}, "tour");
  expect({"match", log, log, "--config", folder.put("a.yaml", "match: {fats: true}\n")}, "fast");
  expect({"match", log, log, "--config", folder.put("b.yaml", "globl: {}\n")}, "global");
  expect({"match", log, log, "--config", folder.put("c.yaml", "match: {method: icq}\n")}, "icp");
  EXPECT_THAT(run_command({"quaternion"}).err, Not(HasSubstr("did you mean")));
}

}  // namespace
}  // namespace phasescan::terminal_test
