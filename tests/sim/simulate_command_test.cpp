// The command `phasescan simulate`, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "io/file.hpp"
#include "phasescan/io/log.hpp"
#include "io/pairs.hpp"
#include "io/tum.hpp"
#include "support/paths.hpp"

namespace phasescan::simulate_command_test {
namespace {

namespace fs = std::filesystem;

class SimulateCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("phasescan-simulate-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Exit code; stderr is left in `said_`.
  int run(const std::string& flags) {
    const std::string command = test::command_path() + " simulate " + flags + " 2> " + path("stderr");
    const int status = std::system(command.c_str());
    said_ = fs::file_size(path("stderr")) ? read_file(path("stderr")) : "";
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path folder_;
  std::string said_;
};

TEST_F(SimulateCommand, MakesALogWithItsTruth) {
  ASSERT_EQ(run("--world flat --sensor ld06 --duration 4 --odometry --people 1 --seed 3 --out " + path("a.jsonl.gz")),
            0)
      << said_;
  ASSERT_EQ(run("--world flat --sensor ld06 --duration 4 --odometry --people 1 --seed 3 --out " + path("b.jsonl.gz")),
            0);
  EXPECT_EQ(read_file(path("a.jsonl.gz")), read_file(path("b.jsonl.gz")));
  const auto truth = read_tum(path("a.jsonl.gz.truth.tum"));
  ASSERT_EQ(truth.size(), 40U);
  const auto log = open_log(path("a.jsonl.gz"));
  std::size_t scans = 0;
  while (const auto entry = log->next()) {
    ASSERT_LT(scans, truth.size());
    EXPECT_EQ(entry->scan.stamp, truth[scans].stamp);
    EXPECT_EQ(entry->scan.size(), 450U);
    EXPECT_GT(entry->scan.time_increment, 0.0);
    EXPECT_TRUE(entry->odometry);
    ++scans;
  }
  EXPECT_EQ(scans, truth.size());
}

TEST_F(SimulateCommand, MakesTheSamePairsWithAnyNumberOfThreads) {
  ASSERT_EQ(run("--pairs 70 --config bench-rows --out " + path("one.jsonl")), 0) << said_;
  ASSERT_EQ(run("--pairs 70 --config bench-rows --threads 3 --out " + path("three.jsonl")), 0) << said_;
  EXPECT_EQ(read_file(path("one.jsonl")), read_file(path("three.jsonl")));
  std::size_t none = 0;
  for (const ScanPair& pair : read_pairs(path("one.jsonl"))) {
    EXPECT_EQ(pair.truth.has_value(), pair.cls != "none");
    none += pair.cls == "none";
    if (pair.dataset == "overlap-40-60") {
      EXPECT_GE(*pair.overlap, 0.4);
      EXPECT_LE(*pair.overlap, 0.6);
    }
  }
  EXPECT_GT(none, 0U);
}

TEST_F(SimulateCommand, TakesWorldsAndPathsFromFiles) {
  write_file(path("den.yaml"), "walls:\n  - {points: [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]}\n");
  write_file(path("way.yaml"), "points: [[1, 1], [3, 1], [3, 2]]\n");
  ASSERT_EQ(
      run("--world " + path("den.yaml") + " --path " + path("way.yaml") + " --speed 0.5 --out " + path("a.jsonl")), 0)
      << said_;
  const auto truth = read_tum(path("a.jsonl.truth.tum"));
  EXPECT_NEAR(truth.front().pose.x, 1.0, 1e-6);
  EXPECT_NEAR(truth.back().pose.y, 2.0, 0.15);
  ASSERT_EQ(run("--world " + path("den.yaml") + " --pairs 5 --classes large --out " + path("p.jsonl")), 0) << said_;
  EXPECT_EQ(read_pairs(path("p.jsonl")).size(), 5U);
}

TEST_F(SimulateCommand, MistakesAreOneLineAndLeaveNothing) {
  for (const std::string& flags : std::vector<std::string>{
           "--world cave", "--sensor gun", "--path maze", "--speed 0", "--speed -1", "--duration 1e9", "--pairs 0",
           "--pairs 2 --path tour", "--pairs 2 --config no-such.yaml", "--pairs 2 --world room --config bench-sim",
           "--classes small", "--config bench-sim", "--pairs 2 --world room --classes huge",
           "--world room --path circle --speed 5 --turn-rate 1"}) {
    EXPECT_EQ(run(flags + " --out " + path("x")), 2) << flags;
    EXPECT_THAT(said_, ::testing::MatchesRegex("phasescan: [^\n]+\n")) << flags;
    EXPECT_FALSE(fs::exists(path("x"))) << flags;
  }
}

}  // namespace
}  // namespace phasescan::simulate_command_test
