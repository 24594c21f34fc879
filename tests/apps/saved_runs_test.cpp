// Saved runs from outside: several logs, resumed, extended and merged runs, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/tum.hpp"
#include "support/command.hpp"
#include "support/toy_world.hpp"

namespace phasescan::saved_runs_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kFiles[] = {"trajectory.tum", "scans.jsonl", "graph.g2o", "map.pgm", "map.yaml", "map.png"};

/// A part of the tour through a world as a CARMEN log. @param wheels_every  of its scans one in so many has odometry
std::string log_of(const std::vector<testing::Wall>& walls, std::size_t from, std::size_t scans, double start_s,
                   double period_s = 0.2, std::uint64_t seed = 77) {
  const auto tour = testing::toy_tour(0.2, 0.4, 1.0, 2);
  testing::ToyLidar lidar;
  lidar.beams = 180;
  std::string text;
  for (std::size_t i = from; i < from + scans; ++i) {
    Random random(seed + i);  // the same scan in whichever log
    const double time = start_s + period_s * static_cast<double>(i - from);
    const Scan scan = testing::toy_scan(walls, tour[i], lidar, random, stamp_from_seconds(time));
    std::string ranges;
    for (const float r : scan.ranges)
      ranges += (ranges.empty() ? "" : ",") + (std::isfinite(r) ? fmt::format("{:.3f}", r) : std::string("null"));
    text += fmt::format(
        R"({{"stamp": {:.3f}, "angle_min": {:.8f}, "angle_increment": {:.8f}, "range_max": 8.0, "ranges": [{}], )"
        R"("odometry": {{"x": {:.4f}, "y": {:.4f}, "theta": {:.5f}}}}})"
        "\n",
        time, scan.geometry.angle_min, scan.geometry.angle_increment, ranges, tour[i].x, tour[i].y, tour[i].theta);
  }
  return text;
}

std::vector<testing::Wall> elsewhere() {
  std::vector<testing::Wall> walls;
  testing::add_box(walls, -4, -3.2, 10, 4.4);
  testing::add_box(walls, -3.1, 1.2, -0.4, 3.9);
  testing::add_box(walls, 1.2, -2.9, 2.6, -1.1);
  walls.push_back({{3.0, 4.4}, {5.5, 1.6}});
  return walls;
}

class SavedRuns : public ::testing::Test {
 protected:
  test::CommandResult run(std::vector<std::string> arguments) const { return run_command(arguments); }
  /// slam with the files of this folder. @param words  files are named by @NAME
  test::CommandResult call(const std::string& words) const {
    std::vector<std::string> arguments;
    std::istringstream in(words);
    for (std::string word; in >> word;) arguments.push_back(word[0] == '@' ? folder_ / word.substr(1) : word);
    return run_command(arguments);
  }
  void expect_same_results(const std::string& one, const std::string& other) const {
    for (const char* file : kFiles) {
      const std::string bytes = slurp(folder_ / (one + "/" + file));
      EXPECT_FALSE(bytes.empty()) << file;
      EXPECT_TRUE(bytes == slurp(folder_ / (other + "/" + file))) << file << " of " << one << " and " << other;
    }
  }
  json summary(const std::string& out) const { return json::parse(slurp(folder_ / (out + "/summary.json"))); }
  void expect_one_line(const test::CommandResult& result, int code, const std::string& what) const {
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(what));
    EXPECT_THAT(result.err, ::testing::StartsWith("phasescan: "));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }

  TempFolder folder_;
};

TEST_F(SavedRuns, ALogThatFollowsAtOnceGoesOnAsOneLog) {
  const auto walls = testing::two_rooms();
  folder_.put("a.jsonl", log_of(walls, 0, 90, 100.0));
  folder_.put("b.jsonl", log_of(walls, 90, 60, 100.0 + 0.2 * 90));
  folder_.put("ab.jsonl", slurp(folder_ / "a.jsonl") + slurp(folder_ / "b.jsonl"));
  ASSERT_EQ(call("slam @ab.jsonl --out @one").code, 0);
  ASSERT_EQ(call("slam @a.jsonl @b.jsonl --out @two").code, 0);
  ASSERT_EQ(call("slam @a.jsonl --out @first --save @a.state").code, 0);
  ASSERT_EQ(call("slam @b.jsonl --resume @a.state --out @resumed --save @b.state").code, 0);
  ASSERT_EQ(call("slam @ab.jsonl --out @none --save @ab.state").code, 0);
  expect_same_results("one", "two");
  expect_same_results("one", "resumed");
  EXPECT_EQ(summary("two")["inputs"].size(), 2u);
  EXPECT_EQ(summary("two")["inputs"][1]["drive"], 0);
  EXPECT_EQ(summary("resumed")["scans"], 150);
  // The log of a saved run given again: what it has is passed over.
  ASSERT_EQ(call("slam @ab.jsonl --resume @ab.state --out @again").code, 0);
  expect_same_results("one", "again");
}

TEST_F(SavedRuns, ALogThatFollowsLaterIsAnotherDrive) {
  const auto walls = testing::two_rooms();
  folder_.put("a.jsonl", log_of(walls, 0, 150, 100.0));
  folder_.put("b.jsonl", log_of(walls, 90, 120, 1000.0));
  ASSERT_EQ(call("slam @a.jsonl @b.jsonl --out @two").code, 0);
  ASSERT_EQ(call("slam @a.jsonl --out @first --save @a.state").code, 0);
  ASSERT_EQ(call("slam @b.jsonl --extend @a.state --out @extended").code, 0);
  expect_same_results("two", "extended");
  EXPECT_EQ(summary("two")["inputs"][1]["drive"], 1);
  EXPECT_EQ(summary("two")["map"]["pieces"], 1);
  // By the gap alone: the same two logs are one drive where it may be an hour.
  folder_.put("hour.yaml", "slam: {session_gap_s: 3600}\n");
  ASSERT_EQ(call("slam @a.jsonl @b.jsonl --config @hour.yaml --out @hour").code, 0);
  EXPECT_EQ(summary("hour")["inputs"][1]["drive"], 0);
}

TEST_F(SavedRuns, SessionGapHoldsToTheSecond) {
  const auto walls = testing::two_rooms();
  folder_.put("a.jsonl", log_of(walls, 0, 20, 100.0));
  const double last = 100.0 + 0.2 * 19;
  for (const auto& [gap, drive] : {std::pair{59.9, 0}, std::pair{60.1, 1}, std::pair{-5.0, 1}}) {
    folder_.put("b.jsonl", log_of(walls, 20, 20, last + gap));
    const auto done = call("slam @a.jsonl @b.jsonl --out @out");
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(summary("out")["inputs"][1]["drive"], drive) << gap;
  }
}

TEST_F(SavedRuns, WhatNothingTiesIsInFoldersOfItsOwn) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 60, 100.0));
  folder_.put("b.jsonl", log_of(elsewhere(), 30, 140, 1000.0));
  folder_.put("c.jsonl", log_of(testing::two_rooms(), 20, 50, 2000.0));
  for (const char* log : {"a", "b", "c"})
    ASSERT_EQ(call(fmt::format("slam @{0}.jsonl --out @{0} --save @{0}.state", log)).code, 0);
  const auto merged = call("merge @c.state @b.state @a.state --out @all --save @all.state");
  EXPECT_EQ(merged.code, 0);
  EXPECT_THAT(merged.err, HasSubstr("in 2 parts"));
  EXPECT_EQ(merged.out, "");
  const json all = summary("all");
  ASSERT_EQ(all["inputs"].size(), 3u);
  for (const json& input : all["inputs"])
    EXPECT_EQ(input["folder"], input["state"] == "b.state" ? "1" : "2") << input;  // the largest is the first
  for (const std::string part : {"1", "2"}) {
    for (const char* file : kFiles) EXPECT_NE(slurp(folder_ / ("all/" + part + "/" + file)), "") << part << file;
    EXPECT_THAT(slurp(folder_ / ("all/" + part + "/report.html")), HasSubstr("</html>"));
    const json loops = summary("all/" + part)["loops"];
    EXPECT_EQ(loops["found"].get<int>(), loops["accepted"].get<int>() + loops["rejected"].get<int>());
    EXPECT_EQ(loops["in_graph"], loops["accepted"]);
  }
  EXPECT_EQ(summary("all/1")["scans"], 140);
  EXPECT_EQ(summary("all/2")["scans"], 110);
  EXPECT_GT(summary("all/2")["loops"]["in_graph"], 0);
  EXPECT_LT(summary("all")["path_length_m"], 60.0);  // from drive to drive nobody drove
  // The saved run holds all; another drive finds its part, and a run without parts takes the folders along.
  EXPECT_THAT(run_command({"info", folder_ / "all.state"}).out, HasSubstr("drives                   3"));
  folder_.put("d.jsonl", log_of(elsewhere(), 100, 60, 3000.0));
  ASSERT_EQ(call("slam @d.jsonl --extend @all.state --out @all").code, 0);
  EXPECT_EQ(summary("all")["inputs"][3]["folder"], "1");
  ASSERT_EQ(call("merge @a.state @c.state --out @all").code, 0);
  EXPECT_FALSE(summary("all")["inputs"][0].contains("folder"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "all/1/summary.json"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "all/2/map.pgm"));
}

TEST_F(SavedRuns, MergedIsTheSameWhateverTheOrderAndTheTime) {
  const auto walls = testing::two_rooms();
  for (std::size_t k = 0; k < 3; ++k) {
    folder_.put(fmt::format("{}.jsonl", k), log_of(walls, 50 * k, 110, 1000.0 * static_cast<double>(k + 1)));
    ASSERT_EQ(call(fmt::format("slam @{0}.jsonl --out @{0} --save @{0}.state", k)).code, 0);
  }
  ASSERT_EQ(call("merge @0.state @1.state @2.state --out @one --save @one.state").code, 0);
  ASSERT_EQ(call("merge @0.state @1.state @2.state --out @two --save @two.state").code, 0);
  ASSERT_EQ(call("merge @0.state @2.state @1.state --out @other --save @other.state").code, 0);
  expect_same_results("one", "two");
  expect_same_results("one", "other");  // the first is the same: so is the frame
  EXPECT_EQ(slurp(folder_ / "one.state"), slurp(folder_ / "two.state"));
  EXPECT_EQ(slurp(folder_ / "one.state"), slurp(folder_ / "other.state"));
  EXPECT_EQ(slurp(folder_ / "one/summary.json"), slurp(folder_ / "other/summary.json"));
  EXPECT_EQ(slurp(folder_ / "one/report.html"), slurp(folder_ / "other/report.html"));
  EXPECT_EQ(summary("one")["map"]["pieces"], 1);
  EXPECT_EQ(summary("one")["scans"], 330);
  EXPECT_EQ(summary("one")["inputs"][2]["state"], "2.state");
  EXPECT_TRUE(summary("one")["odometry"]["used"]);
}

TEST_F(SavedRuns, WhatMergeRefuses) {
  const auto walls = testing::two_rooms();
  folder_.put("a.jsonl", log_of(walls, 0, 30, 100.0));
  folder_.put("b.jsonl", log_of(walls, 20, 30, 1000.0));
  folder_.put("bounded.yaml", "slam: {bounded_memory: true}\n");
  folder_.put("coarse.yaml", "odometry: {cell_m: 0.15}\n");
  folder_.put("text.state", "FLASER 1 2 3\n");
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  ASSERT_EQ(call("slam @b.jsonl --out @b --save @b.state --config @bounded.yaml").code, 0);
  ASSERT_EQ(call("slam @b.jsonl --out @b --save @coarse.state --config @coarse.yaml").code, 0);
  EXPECT_EQ(call("merge --out @x").code, 2);
  EXPECT_EQ(call("merge @a.state").code, 2);
  expect_one_line(call("merge @a.state @a.state --out @x"), 2, "expected different drives");
  expect_one_line(call("merge @a.state @none.state --out @x"), 2, "none.state: does not exist; expected a saved state");
  expect_one_line(call("merge @a.state @a --out @x"), 2, "is a folder");
  expect_one_line(call("merge @a.state @text.state --out @x"), 2, "text.state: is no saved state");
  expect_one_line(call("merge @a.state @b.state --out @x"), 2, "slam.bounded_memory");
  expect_one_line(call("merge @a.state @coarse.state --out @x --config @bounded.yaml"), 2, "slam.bounded_memory");
  expect_one_line(call("merge @a.state --out @x --save @x/map.pgm"), 2, "is a file of --out");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x/summary.json"));
  const auto differs = call("merge @a.state @coarse.state --out @x");
  EXPECT_NE(differs.code, 2) << differs.err;
  EXPECT_THAT(differs.err, HasSubstr("odometry.cell_m 0.1, was 0.15"));
}

TEST_F(SavedRuns, FlagsThatDoNotGoTogetherAndFilesThatAreNone) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 20, 100.0));
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  EXPECT_EQ(call("slam @a.jsonl --out @x --resume @a.state --extend @a.state").code, 2);
  EXPECT_EQ(call("slam --resume @a.state --out @x").code, 2);
  expect_one_line(call("slam @a.jsonl --out @x --resume @none"), 2, "does not exist; expected a saved state");
  expect_one_line(call("slam @a.jsonl --out @x --extend @a.jsonl"), 2, "is no saved state");
  expect_one_line(call("slam @a.jsonl --out @x --save @a.jsonl"), 2, "is the log itself");
  expect_one_line(call("slam @a.jsonl --out @x --save @none/a.state"), 2, "its folder does not exist");
  // Cut off, changed, of a later build: one line each, and nothing is written.
  const std::string state = slurp(folder_ / "a.state");
  std::string changed = state, later = state;
  changed[state.size() / 2] = static_cast<char>(changed[state.size() / 2] ^ 1);
  later[8] = 99;
  folder_.put("cut.state", state.substr(0, state.size() / 2));
  folder_.put("changed.state", changed);
  folder_.put("later.state", later);
  for (const std::string command : {"slam @a.jsonl --out @x --resume", "merge --out @x", "info"}) {
    expect_one_line(call(command + " @cut.state"), 2, "cut.state: is cut off");
    expect_one_line(call(command + " @changed.state"), 2, "does not match its checksum");
    expect_one_line(call(command + " @later.state"), 2, "version 99; this build reads versions 1 to");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x/summary.json"));
}

TEST_F(SavedRuns, AnotherLogThatBeginsLikeTheSavedOneIsRefused) {
  const std::string log = log_of(testing::two_rooms(), 0, 40, 100.0);
  folder_.put("a.jsonl", log);
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  const std::string begin = log.substr(0, log.find('\n') + 1);
  folder_.put("other.jsonl", begin + log_of(testing::two_rooms(), 50, 60, 200.0));
  const auto refused = call("slam @other.jsonl --resume @a.state --out @x");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("begins like the log of the saved run"));
}

TEST_F(SavedRuns, OtherOptionsAreNamedAndThoseThatCannotChangeRefused) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 40, 100.0));
  folder_.put("b.jsonl", log_of(testing::two_rooms(), 40, 20, 108.0));
  folder_.put("coarse.yaml", "odometry: {cell_m: 0.15}\n");
  folder_.put("polish.yaml", "slam: {polish: false}\n");
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @coarse.state --config @coarse.yaml").code, 0);
  const auto other = call("slam @b.jsonl --resume @a.state --config @coarse.yaml --out @x");
  EXPECT_EQ(other.code, 0);
  EXPECT_THAT(other.err, HasSubstr("odometry.cell_m 0.15, was 0.1"));
  expect_one_line(call("slam @b.jsonl --resume @a.state --config @polish.yaml --out @x"), 2,
                  "slam.polish false, was true");
  // Without --config a run keeps its own.
  const auto own = call("slam @b.jsonl --resume @coarse.state --out @x --save @next.state");
  EXPECT_EQ(own.err, "");
  EXPECT_EQ(
      json::parse(run_command({"info", "--json", folder_ / "next.state"}).out)["options_changed"]["odometry.cell_m"],
      "0.15");
  const auto cut = call("slam @b.jsonl --resume @a.state --range-max 4 --out @x");
  EXPECT_THAT(cut.err, HasSubstr("goes on with"));
}

TEST_F(SavedRuns, APackedStateIsReadAgain) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 40, 100.0));
  folder_.put("b.jsonl", log_of(testing::two_rooms(), 40, 20, 108.0));
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state.gz").code, 0);
  EXPECT_EQ(slurp(folder_ / "a.state.gz").substr(0, 2), "\x1f\x8b");
  ASSERT_EQ(call("slam @b.jsonl --resume @a.state --out @plain").code, 0);
  const auto packed = call("slam @b.jsonl --resume @a.state.gz --out @packed");
  ASSERT_EQ(packed.code, 0) << packed.err;
  expect_same_results("plain", "packed");
  EXPECT_EQ(json::parse(run_command({"info", "--json", folder_ / "a.state.gz"}).out)["scans"], 40);
  const auto cut = run_command({"info", folder_ / "a.state.gz", "--from", "3"});
  EXPECT_EQ(cut.code, 2);
  EXPECT_THAT(cut.err, HasSubstr("--from: the file is a saved run, not a log"));
  const std::string bytes = slurp(folder_ / "a.state.gz");
  folder_.put("cut.gz", bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(call("merge @cut.gz --out @x").code, 2);
}

TEST_F(SavedRuns, WhatAKilledSaveLeftIsDeletedByTheNext) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 10, 100.0));
  const std::string gone = ".a.state.tmp99999999-3", alive = ".a.state.tmp" + std::to_string(::getpid()) + "-0",
                    other = ".b.state.tmp99999999-3", text = ".a.state.tmp99999999-3.txt";
  for (const std::string& name : {gone, alive, other, text}) folder_.put(name, "half");
  ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / gone));
  for (const std::string& name : {alive, other, text}) EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
}

TEST_F(SavedRuns, ARunThatIsKilledIsGoneOnWith) {
  folder_.put("a.jsonl", log_of(testing::two_rooms(), 0, 280, 100.0));
  folder_.put("often.yaml", "slam: {autosave_s: 0.01}\n");
  ASSERT_EQ(call("slam @a.jsonl --config @often.yaml --out @whole").code, 0);
  const std::vector<std::string> saving = {"slam",  folder_ / "a.jsonl", "--config", folder_ / "often.yaml",
                                           "--out", folder_ / "killed",  "--save",   folder_ / "a.state"};
  std::size_t killed = 0;
  for (const int after_ms : {1, 15, 30, 60, 120, 200}) {
    std::filesystem::remove(folder_ / "a.state");
    int waited_ms = 0;
    const auto stopped = run_command(saving, "", SIGKILL, [&] {
      waited_ms += std::filesystem::exists(folder_ / "a.state") ? 2 : 0;  // after the first save; polled every 2 ms
      return waited_ms >= after_ms;
    });
    killed += stopped.code == 128 + SIGKILL;
    const auto resumed = call("slam @a.jsonl --resume @a.state --save @a.state --out @resumed");
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    expect_same_results("whole", "resumed");
  }
  EXPECT_GE(killed, 2u);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr(".tmp")));
}

TEST_F(SavedRuns, OdometryThatComesNowAndThenIsNotLookedForInTheNextLog) {
  // Between two samples at most a second apart odometry is interpolated, within a log.
  const auto sparse = [](std::string text, std::size_t every) {
    std::string out;
    std::istringstream in(text);
    std::size_t k = 0;
    for (std::string line; std::getline(in, line); ++k) {
      const std::size_t at = line.find(", \"odometry\"");
      out += (k % every == 0 ? line : line.substr(0, at) + "}") + "\n";
    }
    return out;
  };
  const std::string all = sparse(log_of(testing::two_rooms(), 0, 101, 100.0), 4);
  const auto part = [&all](std::size_t from, std::size_t to) {
    std::string out;
    std::istringstream in(all);
    std::size_t k = 0;
    for (std::string line; std::getline(in, line); ++k) out += k >= from && k < to ? line + "\n" : "";
    return out;
  };
  folder_.put("all.jsonl", all);
  ASSERT_EQ(call("slam @all.jsonl --out @one").code, 0);
  // Cut behind a sample it is one log; cut between two, the scans behind the last sample have none, however the logs
  // are given.
  for (const std::size_t cut : {61u, 63u}) {
    folder_.put("a.jsonl", part(0, cut));
    folder_.put("b.jsonl", part(cut, 101));
    ASSERT_EQ(call("slam @a.jsonl @b.jsonl --out @two").code, 0);
    ASSERT_EQ(call("slam @a.jsonl --out @a --save @a.state").code, 0);
    ASSERT_EQ(call("slam @b.jsonl --resume @a.state --out @resumed").code, 0);
    expect_same_results("two", "resumed");
  }
}

}  // namespace
}  // namespace phasescan::saved_runs_test
