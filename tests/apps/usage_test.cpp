// Flags and file names that mean nothing, through the command: refused in one short line, nothing written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "io/file.hpp"
#include "support/command.hpp"
#include "support/temp.hpp"

namespace phasescan::usage_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::TempFolder;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kScan = R"({"angle_min": 0, "angle_increment": 0.1, "range_max": 6, "ranges": [1, 2, 3, 2, 1]})";

void expect_refusal(const std::vector<std::string>& words, const std::string& what, int code = 2) {
  const CommandResult result = run_command(words);
  EXPECT_EQ(result.code, code) << result.err;
  EXPECT_THAT(result.err, StartsWith("phasescan: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_LT(result.err.size(), 300u) << result.err;
  EXPECT_THAT(result.err, HasSubstr(what));
  EXPECT_EQ(result.out, "");
}

TEST(Usage, NumbersThatAFlagCannotMean) {
  const TempFolder folder;
  const std::string scan = folder.put("scan", kScan + "\n"), out = folder / "out";
  for (const char* seed : {"-1", "18446744073709551616", "1.5", "x", ""}) {
    expect_refusal({"match", scan, scan, "--seed", seed}, "--seed: ");
    expect_refusal({"bench", "--pairs", scan, "--out", out, "--seed", seed}, "--seed: ");
    expect_refusal({"paper", "--quick", "--out", out, "--seed", seed}, "--seed: ");
    expect_refusal({"simulate", "--out", out, "--seed", seed}, "--seed: ");
  }
  for (const char* pairs : {"-1", "0", "18446744073709551616", "1.5", ""})
    expect_refusal({"simulate", "--out", out, "--pairs", pairs}, "--pairs: ");
  for (const char* metres : {"nan", "inf", "0", "-1", "1e999", ""})
    expect_refusal({"slam", scan, "--out", out, "--range-max", metres}, "--range-max: ");
  for (const char* flag : {"--speed", "--turn-rate", "--duration", "--jitter", "--jitter-deg"}) {
    for (const char* value : {"nan", "-1", "inf", "x"})
      expect_refusal({"simulate", "--out", out, flag, value}, std::string(flag) + ": ");
  }
  expect_refusal({"convert", scan, ""}, "OUT: is empty");
  const std::string poses = folder.put("t.tum", "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n");
  expect_refusal({"eval", "--trajectory", poses, "--reference", poses, "--max-gap", "nan"}, "--max-gap: ");
  expect_refusal({"eval", "--trajectory", poses, "--reference", poses, "--delta", "-1"}, "--delta: ");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Usage, AFlagWithoutAMeaningHereIsNotPassedOver) {
  const TempFolder folder;
  const std::string scan = folder.put("scan", kScan), out = folder / "out";
  expect_refusal({"simulate", "--pairs", "2", "--classes", "small", "--out", out}, "--classes: ");
  expect_refusal({"simulate", "--pairs", "2", "--sensor", "ld06", "--out", out}, "--sensor: ");
  expect_refusal({"match", scan, scan, "--config", ""}, "--config: is empty");
  expect_refusal({"match", scan, scan, "--method", ""}, "--method: is empty");
  expect_refusal({"match", scan, scan, "--guess", ""}, "--guess: is empty");
  expect_refusal({"match", scan, scan, "--plot", ""}, "--plot: is empty");
  expect_refusal({"slam", scan, "--out", out, "--mcap", ""}, "--mcap: is empty");
  expect_refusal({"slam", scan, "--out", out, "--topic", "/scan"}, "scan: has no topics: scan log");
  expect_refusal({"info", scan, "--topic", "/scan", "--columns", "stamp,ranges"}, "scan: has no topics");
  const std::string poses = folder.put("t.tum", "0 0 0 0 0 0 0 1\n");
  expect_refusal({"eval", "--trajectory", poses, "--reference", poses, "--laser", "1,0,0"}, "--laser");
  const std::string two = folder.put("c.yaml", "match:\n  fast: true\n---\nmatch:\n  fast: false\n");
  expect_refusal({"config", "--dump", "--config", two}, "c.yaml:3: text after the end of the YAML document");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Usage, AFlagIsNoValueOfTheOneBeforeIt) {
  const TempFolder folder;
  const std::string scan = folder.put("scan", kScan), out = folder / "out";
  expect_refusal({"slam", scan, "--out", "--no-times"}, "--out: has no value before --no-times");
  expect_refusal({"bench", "--pairs", "--out", out}, "--pairs: has no value before --out");
  expect_refusal({"paper", "--out", "--quick"}, "--out: has no value before --quick");
  EXPECT_FALSE(std::filesystem::exists("--no-times"));
}

TEST(Usage, WhatIsNoFolderIsNotWrittenTo) {
  const TempFolder folder;
  const std::string scan = folder.put("scan", kScan), file = folder.put("file", "");
  for (const std::string& out : {file, file + "/x"}) {
    expect_refusal({"slam", scan, "--out", out}, "expected a folder");
    expect_refusal({"paper", "--quick", "--out", out}, "expected a folder");
  }
  expect_refusal({"slam", scan, "--out", ""}, "the folder name is empty");
}

TEST(Usage, ANameThatCannotBeWrittenCostsNoWork) {
  const TempFolder folder;
  // The work would take hours.
  expect_refusal({"bench", "retrieval", "--fit", folder / "no/fit", "--places", "10000000"},
                 "its folder does not exist");
  expect_refusal({"bench", "--sim", "bench-sim", "--count", "10000000", "--features", folder / "no/f.csv", "--out",
                  folder / "out"},
                 "its folder does not exist");
}

TEST(Usage, TrajectoriesAreReadLikeAnyOtherFile) {
  const TempFolder folder;
  const std::string text = "0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n";
  const std::string poses = folder.put("t.tum", text);
  expect_refusal({"eval", "--trajectory", folder / "absent", "--reference", poses}, "absent: no such file");
  expect_refusal({"eval", "--trajectory", poses, "--reference", folder / "absent"}, "absent: no such file");
  expect_refusal({"eval", "--trajectory", folder.path(), "--reference", poses}, "is a folder");
  expect_refusal({"eval", "--trajectory", poses, "--reference", folder.put("none.tum", "")}, "none.tum: not one pose");
  expect_refusal({"eval", "--trajectory", poses, "--relations", folder / "absent"}, "absent: no such file");
  expect_refusal({"eval", "--trajectory", poses, "--relations", folder.path()}, "is a folder");
  write_file(folder / "packed.tum.gz", text);
  const std::string marked = folder.put("marked.tum", "\xEF\xBB\xBF" + text);
  EXPECT_EQ(run_command({"eval", "--trajectory", folder / "packed.tum.gz", "--reference", marked}).code, 0);
  // A step that no trajectory makes is none, not all memory.
  const CommandResult far =
      run_command({"eval", "--trajectory", poses, "--reference", poses, "--delta", "1e300", "--json"});
  ASSERT_EQ(far.code, 0) << far.err;
  EXPECT_EQ(nlohmann::json::parse(far.out)["rpe_m"]["n"], 0);
}

TEST(Usage, HelpThatNobodyCanReadIsAFailure) {
  EXPECT_EQ(run_command({"--help"}, "/dev/full").code, 3);
  EXPECT_EQ(run_command({"match", "--help"}, "/dev/full").code, 3);
  EXPECT_EQ(run_command({"--version"}, "/dev/full").code, 3);
  EXPECT_THAT(run_command({"--help"}).out, HasSubstr("Subcommands"));
}

TEST(Usage, AFileBeyondTheLimitIsAWriteThatFails) {
  const TempFolder folder;
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const CommandResult result = run_command({"simulate", "--duration", "5", "--out", folder / "log.jsonl"});
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("log.jsonl: cannot be written"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Usage, ALogMayComeThroughAPipe) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe", log = folder / "log.jsonl";
  ASSERT_EQ(run_command({"simulate", "--duration", "5", "--odometry", "--out", log}).code, 0);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& from : {log, pipe}) {
    std::thread writer([&] {
      if (from == pipe) std::ofstream(pipe) << test::slurp(log);
    });
    const CommandResult result =
        run_command({"slam", from, "--out", folder / (from == pipe ? "piped" : "filed"), "--no-times"});
    writer.join();
    EXPECT_EQ(result.code, 0) << result.err;
  }
  EXPECT_EQ(test::slurp(folder / "piped/trajectory.tum"), test::slurp(folder / "filed/trajectory.tum"));
  EXPECT_FALSE(test::slurp(folder / "piped/trajectory.tum").empty());
  expect_refusal({"info", "-"}, "standard input:1: the file is empty");
}

TEST(Usage, PairsOfAPipeAreAnsweredAsTheyCome) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe", out = folder / "out";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  bool answered = false;
  std::thread writer([&] {
    std::ofstream file(pipe);
    file << R"({"id": "a", "reference": )" << kScan << R"(, "scan": )" << kScan << "}" << std::endl;
    for (int wait = 0; wait < 1000 && !answered; ++wait) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      answered = test::slurp(out).ends_with("}\n");
    }
  });
  const CommandResult result = run_command({"match", "--pairs", pipe}, out);
  writer.join();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(answered) << "only once the pipe was closed";
}

}  // namespace
}  // namespace phasescan::usage_test
