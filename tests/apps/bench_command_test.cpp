// `phasescan bench` from outside: what it writes, what it refuses, the same bytes for any number of threads.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/xml_check.hpp"

namespace phasescan::test {
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
                                              "icp,fft-icp2,fft-mh", "--no-times", "--threads", threads, "--out", out});
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
  EXPECT_TRUE(json.at("options").contains("fft-mh"));
  EXPECT_FALSE(json.at("rows").at(0).contains("ms"));
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
}  // namespace phasescan::test
