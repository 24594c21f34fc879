// `phasescan bench` from outside: what it writes, what it refuses, the same bytes for any number of threads.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/xml_check.hpp"
#include "support/paths.hpp"

namespace phasescan::test::bench_command_test {
namespace {

std::string read_all(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::string all;
  for (const std::string& name : names) all += name + "\n" + slurp(folder + "/" + name);
  return all;
}

TEST(BenchCommand, SimulatedPairsGiveTablesAndFiguresWithTheSameBytesForAnyThreads) {
  const TempFolder folder;
  std::string first;
  for (const char* threads : {"1", "2"}) {
    const std::string out = folder / threads;
    const CommandResult result = run_command({"bench", "--sim", "bench-sim", "--count", "40", "--seed", "5", "--method",
                                              "icp,fft-icp2,global", "--no-times", "--threads", threads, "--out", out});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, "");
    for (const char* name : {"success.svg", "overlap.svg", "errors.svg", "reliability.svg"}) {
      EXPECT_EQ(xml_error(slurp(out + "/" + name)), "") << name;
    }
    EXPECT_FALSE(std::filesystem::exists(out + "/time.svg"));
    if (first.empty()) first = read_all(out);
    EXPECT_TRUE(read_all(out) == first) << "other bytes with " << threads << " threads";
  }
  const auto json = nlohmann::json::parse(slurp(folder / "1/results.json"));
  EXPECT_EQ(json.at("pairs"), 40);
  EXPECT_EQ(json.at("rows").size(), 5u * 4u * 3u);
  EXPECT_TRUE(json.at("options").contains("global"));
  EXPECT_FALSE(json.at("rows").at(0).contains("ms"));
}

TEST(BenchCommand, VariantsAreColumnsAndAWrongOneIsNamed) {
  const TempFolder folder;
  const CommandResult result =
      run_command({"bench", "--sim", "bench-sim", "--count", "10", "--method", "global", "--variant",
                   "no twins: global.twins=false", "--variant",
                   "blind: global.free_space=false, global.missing_data=false", "--out", folder / "out"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto json = nlohmann::json::parse(slurp(folder / "out/results.json"));
  EXPECT_EQ(json.at("options").at("no twins").at("global").at("twins"), false);
  EXPECT_EQ(json.at("options").at("blind").at("global").at("twins"), true);
  EXPECT_EQ(json.at("totals").back().at("method"), "blind");
  EXPECT_TRUE(json.at("rows").at(0).at("weak").contains("across_below_0_1_m"));
  const CommandResult wrong =
      run_command({"bench", "--sim", "bench-sim", "--variant", "x: global.twin=false", "--out", folder / "none"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("no option global.twin"), std::string::npos) << wrong.err;
}

TEST(BenchCommand, FiguresOfAnEarlierRunDoNotStandBesideTheResults) {
  const TempFolder folder;
  const auto bench = [&](const std::string& method, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"bench",    "--sim", "bench-sim", "--count",     "4",
                                          "--method", method,  "--out",     folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  };
  ASSERT_EQ(bench("global", {}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/time.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/reliability.svg"));
  folder.put("out/mine.svg", "of the user");
  ASSERT_EQ(bench("icp", {"--no-times"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/time.svg"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/reliability.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/success.svg"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/mine.svg"));
  // A file that cannot be written is refused before the work, and nothing changes.
  const std::string before = read_all(folder / "out");
  EXPECT_EQ(bench("ndt", {"--features", folder / "no/where.csv"}).code, 2);
  EXPECT_EQ(read_all(folder / "out"), before);
}

TEST(BenchCommand, OutIsAFolder) {
  const TempFolder folder;
  const std::string file = folder.put("file", "kept");
  const CommandResult result = run_command({"bench", "--sim", "bench-sim", "--count", "1", "--out", file});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("file: is a file, or lies in one; expected a folder"), std::string::npos) << result.err;
  EXPECT_EQ(slurp(file), "kept");
}

TEST(BenchCommand, ScalingWritesItsFigureAndPrintsTheExponents) {
  const TempFolder folder;
  const CommandResult result =
      run_command({"bench", "scaling", "--count", "3", "--repeat", "1", "--out", folder / "out"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("time against beams"), std::string::npos);
  EXPECT_NE(result.out.find("time against range"), std::string::npos);
  EXPECT_EQ(slurp(folder / "out/scaling.md"), result.out);
  EXPECT_EQ(xml_error(slurp(folder / "out/scaling.svg")), "");
  EXPECT_EQ(run_command({"bench", "scaling"}).code, 2);
}

TEST(BenchCommand, TheConfidenceIsFittedOnWhatFeaturesWrites) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) GTEST_SKIP() << "no python3-numpy";
  const TempFolder folder;
  for (const char* seed : {"1", "2"}) {
    const CommandResult result =
        run_command({"bench", "--sim", "bench-honesty", "--count", "300", "--seed", seed, "--method", "global",
                     "--features", folder / (std::string(seed) + ".csv"), "--out", folder / "out"});
    ASSERT_EQ(result.code, 0) << result.err;
  }
  const std::string command = "/usr/bin/python3 " + source_dir() + "/tools/fit_confidence.py --sim " +
                              (folder / "1.csv") + " --real " + (folder / "2.csv") + " --out " +
                              (folder / "left-out.md") + " > " + (folder / "printed");
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_NE(slurp(folder / "printed").find("kCoefficients{"), std::string::npos);
  const std::string tables = slurp(folder / "left-out.md");
  EXPECT_NE(tables.find("| sim-room | "), std::string::npos);
  EXPECT_EQ(tables.find("nan"), std::string::npos) << tables;
}

TEST(BenchCommand, UnknownClassesAreReportedAsTheyCome) {
  const TempFolder folder;
  const std::string scan = R"({"angle_min":-3,"angle_increment":0.1,"range_min":0.1,"range_max":6,"ranges":[1,2,3]})";
  const std::string pairs =
      folder.put("few.jsonl", R"({"id":"a","class":"odd","reference":)" + scan + R"(,"scan":)" + scan +
                                  R"(,"truth":{"x":0,"y":0,"theta":0}})"
                                  "\n"
                                  R"({"id":"b","class":"none","reference":)" +
                                  scan + R"(,"scan":)" + scan +
                                  R"(,"truth":null})"
                                  "\n");
  const CommandResult result = run_command({"bench", "--pairs", pairs, "--method", "icp", "--out", folder / "out"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto json = nlohmann::json::parse(slurp(folder / "out/results.json"));
  ASSERT_EQ(json.at("rows").size(), 2u);
  EXPECT_EQ(json.at("rows").at(0).at("class"), "none");
  EXPECT_EQ(json.at("rows").at(1).at("class"), "odd");
  EXPECT_EQ(json.at("rows").at(1).at("dataset"), "few");
  EXPECT_TRUE(json.at("rows").at(1).contains("ms"));
}

TEST(BenchCommand, BadInputIsOneLineAndLeavesNoResults) {
  const TempFolder folder;
  const std::string scan = R"({"angle_min":0,"angle_increment":0.1,"range_min":0,"range_max":6,"ranges":[1]})";
  const std::string no_truth =
      folder.put("truth.jsonl", R"({"id":"a","class":"small","reference":)" + scan + R"(,"scan":)" + scan + "}\n");
  const std::string no_class = folder.put("class.jsonl", R"({"id":"a","reference":)" + scan + R"(,"scan":)" + scan +
                                                             R"(,"truth":{"x":0,"y":0,"theta":0}})"
                                                             "\n");
  const std::string cut = folder.put("cut.jsonl", "{\"id\":");
  const auto expect = [&](std::vector<std::string> arguments, int code, const std::string& said) {
    arguments.insert(arguments.begin(), "bench");
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.code, code) << said;
    EXPECT_NE(result.err.find(said), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/results.json"));
  };
  expect({"--pairs", no_truth, "--out", folder / "out"}, 2, "truth.jsonl:1: no \"truth\"");
  expect({"--pairs", no_class, "--out", folder / "out"}, 2, "class.jsonl:1: no \"class\"");
  expect({"--pairs", cut, "--out", folder / "out"}, 2, "cut.jsonl:1: ");
  expect({"--pairs", folder / "absent", "--out", folder / "out"}, 2, "absent");
  expect({"--sim", "nothing", "--out", folder / "out"}, 2, "bench-sim");
  expect({"--sim", "bench-sim", "--method", "icp,icp", "--out", folder / "out"}, 2, "named twice");
  expect({"--sim", "bench-sim", "--method", "nothing", "--out", folder / "out"}, 2, "--method");
  expect({"--sim", "bench-sim"}, 2, "--out");
  expect({"--out", folder / "out"}, 2, "--pairs");
  expect({"--sim", "bench-sim", "--count", "1", "--out", "/proc/none/out"}, 3, "/proc/none/out");
}

}  // namespace
}  // namespace phasescan::test::bench_command_test
