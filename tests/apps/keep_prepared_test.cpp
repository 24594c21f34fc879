// localize --keep-prepared from outside: the same answers with a kept map and without, and what is said where it is of
// no use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "localize/prepared_file.hpp"
#include "output/map_file.hpp"
#include "support/command.hpp"
#include "support/sealed_state.hpp"
#include "support/toy_log.hpp"
#include "support/toy_map.hpp"

namespace phasescan::keep_prepared_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;
using Words = std::vector<std::string>;

/// A folder with a map of the toy world and a drive in it.
struct Place {
  TempFolder folder;
  std::string yaml, kept;
  Place() : yaml(folder / "map.yaml"), kept(yaml + ".prepared") {
    draw(testing::toy_map(testing::two_rooms(), {0, 0}, 0.05, 0.3));
    folder.put("toy.log", testing::toy_log(120).flaser);
  }
  void draw(const TrinaryMap& map) const {
    folder.put("map.pgm", format_pgm(map));
    folder.put("map.yaml", format_map_yaml(map, "map.pgm"));
  }
  test::CommandResult run(const Words& more = {}, const Words& map = {}) const {
    Words words = {"localize", folder / "toy.log", "--out", folder / "out"};
    const Words known = map.empty() ? Words{"--map", yaml} : map;
    words.insert(words.end(), known.begin(), known.end());
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  /// What a run without times writes, which must have gone well and said `expected` in one line, or nothing.
  std::string answers(const Words& more, const std::string& expected = "", const Words& map = {}) const {
    Words words = {"--no-times"};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run(words, map);
    EXPECT_EQ(result.code, 0) << result.err;
    std::string said;  // of the kept map: a verdict may be said too
    for (const std::string& line : testing::lines_of(result.err))
      said += line.find("prepared") == std::string::npos ? "" : line;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), expected.empty() ? 0 : 1) << said;
    EXPECT_THAT(said, HasSubstr(expected));
    std::string all;
    for (const char* file : {"localization.jsonl", "summary.json", "report.html", "trajectory.tum"})
      all += slurp(folder / ("out/" + std::string(file)));
    return all;
  }
  bool was_kept() const { return json::parse(slurp(folder / "out/summary.json"))["map"]["was_kept"]; }
};

const Words kKeep = {"--keep-prepared"};

TEST(KeepPrepared, AnswersAreTheSameBytesWithAKeptMapAndWithout) {
  const Place place;
  for (const Words& flags : {Words{}, Words{"--each"}}) {
    const std::string plain = place.answers(flags);
    EXPECT_FALSE(std::filesystem::exists(place.kept));
    std::string bytes;
    for (const char* threads : {"1", "1", "2"}) {
      Words keep = flags;
      keep.insert(keep.end(), {"--keep-prepared", "--threads", threads});
      EXPECT_EQ(place.answers(keep), plain);
      EXPECT_TRUE(bytes.empty() || slurp(place.kept) == bytes);
      bytes = slurp(place.kept);
      EXPECT_GT(bytes.size(), 10'000U);
    }
    std::filesystem::remove(place.kept);
  }
  EXPECT_EQ(place.run(kKeep).code, 0);
  EXPECT_FALSE(place.was_kept());
  EXPECT_EQ(place.run(kKeep).code, 0);
  EXPECT_TRUE(place.was_kept());
}

TEST(KeepPrepared, ASavedRunIsKeptTooAndOneThatChangedIsPreparedAnew) {
  const Place place;
  const std::string state = place.folder / "toy.state";
  const auto save = [&](const std::string& log) {
    ASSERT_EQ(run_command({"slam", log, "--out", place.folder / "slam", "--save", state}).code, 0);
  };
  save(place.folder / "toy.log");
  const Words map = {"--state", state};
  const std::string plain = place.answers({}, "", map);
  EXPECT_EQ(place.answers(kKeep, "", map), plain);
  EXPECT_TRUE(std::filesystem::exists(state + ".prepared"));
  EXPECT_EQ(place.answers(kKeep, "", map), plain);
  EXPECT_EQ(place.run(kKeep, map).code, 0);
  EXPECT_TRUE(place.was_kept());
  save(place.folder.put("more.log", testing::toy_log(140).flaser));
  const std::string after = place.answers({}, "", map);
  EXPECT_EQ(place.answers(kKeep, "toy.state.prepared: is of another map; the map is prepared anew", map), after);
  EXPECT_EQ(place.answers(kKeep, "", map), after);
  place.folder.put("toy.state", slurp(state).substr(0, 5000));
  EXPECT_EQ(place.run(kKeep, map).code, 2);
}

/// One line, the same answers as without, and the next run reads what this one wrote.
TEST(KeepPrepared, WhatIsNotOfThisMapIsSaidAndWrittenAnew) {
  const Place place;
  const std::string plain = place.answers({});
  EXPECT_EQ(place.answers(kKeep), plain);
  const std::string good = slurp(place.kept);
  std::string damaged = good, later = good, turned = good;
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  testing::put_state_number(later, 8, 4, kPreparedVersion + 1);
  testing::put_state_number(turned, 8, 4, kPreparedVersion << 24);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {good.substr(0, good.size() / 3), "is cut off"},
      {"", "is no prepared map"},
      {damaged, "is damaged: section"},
      {testing::sealed(later), "is a prepared map of version 2"},
      {testing::sealed(turned), "is a prepared map of version 16777216"},
      {"image: map.pgm\n", "is no prepared map"},
  };
  for (const auto& [bytes, expected] : cases) {
    place.folder.put("map.yaml.prepared", bytes);
    EXPECT_EQ(place.answers(kKeep, "map.yaml.prepared: " + expected), plain) << expected;
    EXPECT_EQ(slurp(place.kept), good) << expected;
    EXPECT_EQ(place.answers(kKeep), plain);
  }
}

TEST(KeepPrepared, AMapOrOptionsThatChangedAreNoticed) {
  const Place place;
  ASSERT_EQ(place.run(kKeep).code, 0);
  TrinaryMap other = testing::toy_map(testing::two_rooms(), {0, 0}, 0.05, 0.3);
  const auto free = std::find(other.cells.begin() + static_cast<std::ptrdiff_t>(other.cells.size() / 2),
                              other.cells.end(), CellState::kFree);
  *free = CellState::kOccupied;
  place.draw(other);
  EXPECT_EQ(place.answers(kKeep, "is of another map; the map is prepared anew"), place.answers({}));
  other.origin.x += 1.0;
  place.draw(other);
  EXPECT_EQ(place.answers(kKeep, "is of another map"), place.answers({}));
  const Words coarser = {"--config", place.folder.put("coarser.yaml", "localize:\n  view_spacing_m: 0.5\n")};
  Words keep = coarser;
  keep.push_back("--keep-prepared");
  EXPECT_EQ(place.answers(keep, "was prepared with other options"), place.answers(coarser));
  EXPECT_EQ(place.answers(keep), place.answers(coarser));
  keep[1] = place.folder.put("surer.yaml", "localize:\n  view_spacing_m: 0.5\n  candidates: 100\n");
  EXPECT_EQ(place.answers(keep), place.answers({"--config", keep[1]}));
}

/// A folder stands in the way, as nobody else may keep root from writing: one line, and the run goes on.
TEST(KeepPrepared, WhereNothingCanBeWrittenTheRunGoesOn) {
  const Place place;
  const std::string plain = place.answers({});
  std::filesystem::create_directory(place.kept);
  const auto run = place.run({"--no-times", "--keep-prepared"});
  EXPECT_EQ(run.code, 0);
  EXPECT_THAT(run.err, HasSubstr("map.yaml.prepared: is no file; expected a file"));
  EXPECT_THAT(run.err, HasSubstr("is a folder; expected a file to write; the prepared map is not kept"));
  std::filesystem::remove(place.kept);
  if (::geteuid() == 0) return;
  std::filesystem::permissions(place.folder.path(),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const TempFolder elsewhere;
  const auto kept_out = run_command(
      {"localize", "--map", place.yaml, place.folder / "toy.log", "--keep-prepared", "--out", elsewhere / "out"});
  std::filesystem::permissions(place.folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(kept_out.code, 0) << kept_out.err;
  EXPECT_THAT(kept_out.err, HasSubstr("the prepared map is not kept"));
  EXPECT_EQ(std::count(kept_out.err.begin(), kept_out.err.end(), '\n'), 1) << kept_out.err;
}

/// All of them prepare and write: each file that is renamed is whole.
TEST(KeepPrepared, RunsAtTheSameTimeDoNotDisturbEachOther) {
  const Place place;
  std::vector<pid_t> children;
  for (int c = 0; c < 4; ++c) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    const auto run = run_command({"localize", "--map", place.yaml, place.folder / "toy.log", "--keep-prepared", "--out",
                                  place.folder / ("out" + std::to_string(c))});
    ::_exit(run.code == 0 && run.err.empty() ? 0 : 1);
  }
  for (const pid_t child : children) {
    int status = -1;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  ASSERT_EQ(place.run(kKeep).code, 0);
  EXPECT_TRUE(place.was_kept());
  for (const auto& entry : std::filesystem::directory_iterator(place.folder.path()))
    EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
}

TEST(KeepPrepared, BenchSaysWhatKeepingSaves) {
  const Place place;
  const auto run = run_command({"bench", "prepared", place.yaml, "--runs", "3"});
  ASSERT_EQ(run.code, 0) << run.err;
  const json line = json::parse(run.out);
  EXPECT_GT(line["kept_bytes"], 10'000);
  EXPECT_LT(line["kept_ms"].get<double>(), line["anew_ms"].get<double>());
}

}  // namespace
}  // namespace phasescan::keep_prepared_test
