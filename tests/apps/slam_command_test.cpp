// The slam and eval commands from outside: whole runs, good logs and bad ones, the same bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "support/command.hpp"
#include "support/toy_log.hpp"

namespace phasescan::slam_command_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;
using testing::lines_of;
using ::testing::Not;
using testing::toy_log;
using testing::ToyLog;

json summary_in(const TempFolder& folder) {
  return json::parse(slurp(folder / "out/summary.json"));
}

test::CommandResult slam(const TempFolder& folder, const std::string& text, std::vector<std::string> more = {}) {
  folder.put("toy.log", text);
  std::vector<std::string> arguments = {"slam", folder / "toy.log", "--out", folder / "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_command(arguments);
}

TEST(SlamCommand, AWholeRunLeavesEveryFileAndAnAccurateTrajectory) {
  const TempFolder folder;
  const ToyLog log = toy_log();
  const auto run = slam(folder, log.flaser, {"--odometry", "none"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), log.scans);
  const TrinaryMap map = read_map(folder / "out/map.yaml");
  EXPECT_GT(std::count(map.cells.begin(), map.cells.end(), CellState::kFree), 5000);
  EXPECT_THAT(slurp(folder / "out/graph.g2o"), HasSubstr("EDGE_SE2 0 1 "));
  EXPECT_THAT(slurp(folder / "out/report.html"), HasSubstr("</html>"));
  EXPECT_EQ(slurp(folder / "out/map.png").substr(1, 3), "PNG");
  const json summary = summary_in(folder);
  EXPECT_EQ(summary["scans"], log.scans);
  EXPECT_TRUE(summary["complete"]);
  EXPECT_TRUE(summary["warnings"].empty());
  EXPECT_TRUE(summary["loops"].contains("places"));
  const auto& loops = summary["loops"];
  EXPECT_GT(loops["found"], 0);
  EXPECT_EQ(loops["found"].get<int>(), loops["accepted"].get<int>() + loops["rejected"].get<int>()) << loops;
  const json timing = json::parse(slurp(folder / "out/timing.json"));
  EXPECT_GT(timing["peak_memory_mib"], 1.0);
  EXPECT_GT(timing["tracking_cpu_ms"]["mean"], 0.0);
  EXPECT_LT(timing["tracking_cpu_ms"]["mean"], timing["step_cpu_ms"]["mean"]);  // one thread: loops fall between scans
  folder.put("truth.tum", log.truth);
  const auto eval = run_command(
      {"eval", "--trajectory", folder / "out/trajectory.tum", "--reference", folder / "truth.tum", "--json"});
  EXPECT_EQ(eval.code, 0) << eval.err;
  EXPECT_LT(json::parse(eval.out)["ate_m"]["rmse"], 0.03);
}

/// The log, but that all scans from `first` on have three returns and no more.
std::string blinded(const std::string& log, std::size_t first) {
  std::string text;
  std::size_t k = 0;
  for (const std::string& line : lines_of(log)) {
    std::istringstream words(line);
    std::string word;
    for (int n = 0; words >> word; ++n) {
      const bool beam = n >= 2 && n < 362;
      text += (n > 0 ? " " : "") + (k >= first && beam && n % 120 != 5 ? std::string("0.000") : word);
    }
    text += "\n";
    ++k;
  }
  return text;
}

TEST(SlamCommand, AGoodRunSaysSoAndNothingOnStderr) {
  const TempFolder folder;
  const auto run = slam(folder, toy_log().flaser, {"--odometry", "none"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const json summary = summary_in(folder);
  EXPECT_EQ(summary["verdict"], "good");
  EXPECT_GE(summary["verdict_probability"], 0.95);
  EXPECT_TRUE(summary["reasons"].is_array());
  EXPECT_EQ(summary["evidence"]["scans"], 200);
  EXPECT_THAT(slurp(folder / "out/report.html"),
              HasSubstr("good: the trajectory is within 0.2 m or 1 % of its length"));
}

TEST(SlamCommand, ARunOfWhichHalfIsOnNoMapFailsAndLeavesItsFiles) {
  const TempFolder folder;
  const auto run = slam(folder, blinded(toy_log(120).flaser, 40), {"--odometry", "none"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.err, HasSubstr("failed: "));
  const json summary = summary_in(folder);
  EXPECT_EQ(summary["verdict"], "failed");
  EXPECT_LE(summary["verdict_probability"], 0.2);
  ASSERT_FALSE(summary["reasons"].empty());
  for (const json& reason : summary["reasons"]) {
    EXPECT_GT(reason["count"], 0);
    EXPECT_TRUE(reason["first_stamp"].is_number());
    EXPECT_FALSE(reason["what"].get<std::string>().empty());
    EXPECT_TRUE(reason["kind"].is_string());
  }
  EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), 120u);
  EXPECT_THAT(slurp(folder / "out/report.html"), HasSubstr("failed: "));
}

TEST(SlamCommand, LogsThatNothingTiesAreDoubtfulAndNoError) {
  const TempFolder folder;
  folder.put("a.log", toy_log(60).flaser);
  std::string corridor;
  Random random(5);
  for (int i = 0; i < 60; ++i) {
    testing::ToyLidar lidar;
    lidar.beams = 360, lidar.field = kPi, lidar.range_max = 0.0;
    const Scan scan = testing::toy_scan(testing::corridor_with_niches(30.0, 0.7), {4.0 + 0.05 * i, 0.0, 0.0}, lidar,
                                        random, stamp_from_seconds(0.0));
    corridor += "FLASER 360";
    for (const float r : scan.ranges) corridor += " " + std::to_string(r);
    corridor += " 0 0 0 0 0 0 " + std::to_string(9000.0 + 0.2 * i) + " host " + std::to_string(0.2 * i) + "\n";
  }
  folder.put("b.log", corridor);
  const auto run =
      run_command({"slam", folder / "a.log", folder / "b.log", "--out", folder / "out", "--odometry", "none"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("doubtful: pieces: "));
  const json summary = summary_in(folder);
  EXPECT_EQ(summary["verdict"], "doubtful");
  EXPECT_EQ(summary["reasons"][0]["kind"], "pieces");
  EXPECT_TRUE(json::parse(slurp(folder / "out/1/summary.json")).contains("verdict"));
}

TEST(SlamCommand, SameBytesWhateverTheThreads) {
  const TempFolder one, two;
  const ToyLog log = toy_log();
  EXPECT_EQ(slam(one, log.flaser, {"--no-times"}).code, 0);
  EXPECT_EQ(slam(two, log.flaser, {"--no-times", "--threads", "2"}).code, 0);
  for (const char* file :
       {"trajectory.tum", "graph.g2o", "map.pgm", "map.yaml", "map.png", "summary.json", "report.html"}) {
    EXPECT_EQ(slurp(one / "out/" + file), slurp(two / "out/" + file)) << file;
  }
  EXPECT_EQ(slurp(one / "out/timing.json"), "");
}

TEST(SlamCommand, SectionsThatItDoesNotReadAreNamed) {
  const TempFolder one, two;
  const std::string log = toy_log(60).flaser;
  two.put("options.yaml", "match: {min_confidence: 1.0}\nmh: {candidates: 1}\nicp: {max_iterations: 5}\n");
  ASSERT_EQ(slam(one, log).code, 0);
  const auto result = slam(two, log, {"--config", two / "options.yaml"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("section 'icp' is not read by slam"));
  EXPECT_THAT(result.err, Not(HasSubstr("'match'")));
  EXPECT_THAT(result.err, Not(HasSubstr("'global'")));
}

TEST(SlamCommand, ScansJsonlHasALinePerScanWithStatusPosesAndCovariance) {
  const TempFolder folder;
  ASSERT_EQ(slam(folder, toy_log(60).flaser).code, 0);
  const auto lines = lines_of(slurp(folder / "out/scans.jsonl"));
  ASSERT_EQ(lines.size(), 60u);
  for (const std::string& line : lines) {
    const auto scan = nlohmann::json::parse(line);
    EXPECT_EQ(scan.at("status"), "ok") << line;
    EXPECT_TRUE(scan.at("left_out").is_null());
    for (const char* pose : {"pose", "odom_pose"}) {
      for (const char* number : {"x", "y", "theta"}) EXPECT_TRUE(scan.at(pose).at(number).is_number()) << line;
    }
    ASSERT_EQ(scan.at("covariance").size(), 9u);
    for (const int diagonal : {0, 4, 8}) EXPECT_GT(scan.at("covariance").at(static_cast<std::size_t>(diagonal)), 0.0);
  }
  const auto first = nlohmann::json::parse(lines.front()), last = nlohmann::json::parse(lines.back());
  EXPECT_LT(first.at("stamp").get<double>(), last.at("stamp").get<double>());
}

TEST(SlamCommand, ResultsOfTwoRunsDoNotMix) {
  const TempFolder folder;
  const ToyLog log = toy_log(60);
  const auto all = [&] {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out"))
      files[entry.path().filename().string()] = slurp(entry.path().string());
    return files;
  };
  ASSERT_EQ(slam(folder, log.flaser).code, 0);
  folder.put("out/notes.txt", "of the user");
  const auto first = all();
  EXPECT_EQ(first.size(), 10u);
  // Runs that end in nothing leave what was there, every byte of it.
  const std::string shorter = toy_log(40).flaser;
  EXPECT_EQ(slam(folder, "PARAM robot_frontlaser_offset 0.0 nohost 0\n").code, 1);
  EXPECT_EQ(all(), first);
  EXPECT_EQ(slam(folder, shorter, {"--mcap", folder / "no/where.mcap"}).code, 2);
  EXPECT_EQ(all(), first);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 8192;  // the trajectory goes in, the map does not
  folder.put("toy.log", shorter);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto full = run_command({"slam", folder / "toy.log", "--out", folder / "out"});
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(full.code, 3) << full.err;
  EXPECT_EQ(all(), first);
  // One without times takes the old ones away.
  EXPECT_EQ(slam(folder, shorter, {"--no-times"}).code, 0);
  const auto second = all();
  EXPECT_EQ(second.size(), 9u);
  EXPECT_EQ(second.count("timing.json"), 0u);
  EXPECT_EQ(second.count("notes.txt"), 1u);
}

TEST(SlamCommand, BadLogsEndInAMapOfWhatWasGood) {
  const auto good = lines_of(toy_log(120).flaser);
  const auto joined = [](const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line;
    return text;
  };
  struct Case {
    const char* name;
    std::string text, warning;
    int code;
    std::size_t scans;
  };
  std::vector<Case> cases;
  {
    auto lines = good;
    lines[60] = lines[60].substr(0, 300) + "\n";
    cases.push_back({"a line cut short", joined(lines), "", 4, 119});
  }
  cases.push_back({"the end cut off", joined(good).substr(0, joined(good).size() - 400), "", 4, 119});
  {
    auto lines = good;
    lines.insert(lines.begin() + 50, lines[49]);
    cases.push_back({"a doubled scan", joined(lines), "repeated scan", 4, 121});
  }
  {
    auto lines = good;
    std::swap(lines[40], lines[80]);
    cases.push_back({"time going backwards", joined(lines), "time going backwards", 4, 120});
  }
  {
    auto lines = good;
    lines.erase(lines.begin() + 30, lines.begin() + 90);
    cases.push_back({"a gap", joined(lines), "gap", 0, 60});
  }
  for (const Case& c : cases) {
    const TempFolder folder;
    const auto run = slam(folder, c.text, {"--odometry", "none"});
    EXPECT_EQ(run.code, c.code) << c.name << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("warning")) << c.name;
    EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), c.scans) << c.name;
    const json warnings = summary_in(folder)["warnings"];
    EXPECT_FALSE(warnings.empty()) << c.name;
    if (!c.warning.empty()) {
      EXPECT_TRUE(warnings.contains(c.warning)) << c.name << warnings;
    }
    EXPECT_GT(read_map(folder / "out/map.yaml").cells.size(), 1000u) << c.name;
  }
}

TEST(SlamCommand, RefusesWithOneLine) {
  const TempFolder folder;
  EXPECT_EQ(run_command({"slam", folder / "none.log", "--out", folder / "out"}).code, 2);
  EXPECT_EQ(run_command({"slam"}).code, 2);
  const auto empty = slam(folder, "# nothing\nPARAM robot_frontlaser_offset 0.0 nohost 0\n");
  EXPECT_EQ(empty.code, 1) << empty.err;
  const auto eval = run_command({"eval", "--trajectory", folder.put("t.tum", "1 0 0 0 0 0 0 1\n")});
  EXPECT_EQ(eval.code, 2);
  EXPECT_THAT(eval.err, HasSubstr("--reference"));
  const auto bad = run_command(
      {"eval", "--trajectory", folder.put("b.tum", "1 0 0 0 0 0 0 1\n1 2 3\n"), "--relations", folder / "r"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("b.tum:2: "));
}

TEST(EvalCommand, RelationsByHand) {
  const TempFolder folder;
  const std::string t = folder.put("t.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n");
  const std::string r = folder.put("r.relations", "0 1 1 0 0 0 0 0\n1 2 0.7 0.4 0 0 0 0.1\n0 9 1 0 0 0 0 0\n");
  const auto run = run_command({"eval", "--trajectory", t, "--relations", r, "--json"});
  ASSERT_EQ(run.code, 0) << run.err;
  const json j = json::parse(run.out);
  EXPECT_EQ(j["unanswered"], 1);
  EXPECT_NEAR(j["translation_m"]["mean"], 0.25, 1e-5);
  EXPECT_NEAR(j["rotation_deg"]["max"], rad_to_deg(0.1), 1e-4);
  EXPECT_NEAR(j["translation_squared_m2"]["mean"], 0.125, 1e-5);
  EXPECT_EQ(j["above_0.2_m"], 1);
}

TEST(EvalCommand, ClosureSeesAShiftBetweenTwoVisits) {
  const TempFolder folder;
  const ToyLog log = toy_log(1000);
  const std::string path = folder.put("tour.log", log.flaser);
  // The truth closes; with the second half of it moved by 10 cm it does not.
  std::string shifted;
  std::size_t number = 0;
  for (const StampedPose& p : read_tum(folder.put("truth.tum", log.truth))) {
    const bool late = 2 * number++ > log.scans;
    shifted +=
        format_tum(std::vector<StampedPose>{{p.stamp, Pose2{p.pose.x + (late ? 0.1 : 0.0), p.pose.y, p.pose.theta}}});
  }
  const auto closed = run_command({"eval", "--trajectory", folder / "truth.tum", "--closure", path, "--json"});
  ASSERT_EQ(closed.code, 0) << closed.err;
  EXPECT_GT(json::parse(closed.out)["matched"], 5);
  EXPECT_LT(json::parse(closed.out)["translation_m"]["median"], 0.02);
  const auto open =
      run_command({"eval", "--trajectory", folder.put("shifted.tum", shifted), "--closure", path, "--json"});
  ASSERT_EQ(open.code, 0) << open.err;
  EXPECT_NEAR(json::parse(open.out)["translation_m"]["median"], 0.1, 0.02);
  const auto short_one =
      run_command({"eval", "--trajectory", folder.put("short.tum", "1000 0 0 0 0 0 0 1\n"), "--closure", path});
  EXPECT_EQ(short_one.code, 2);
}

}  // namespace
}  // namespace phasescan::slam_command_test
