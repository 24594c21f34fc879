// Ctrl-C and SIGTERM: the same exit code from every command, what was finished is whole, nothing half-written stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "io/tum.hpp"
#include "support/command.hpp"
#include "support/toy_log.hpp"

namespace phasescan::stop_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::CommandResult;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;

/// Names in a folder, none where there is no folder.
std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) names.push_back(entry.path().filename().string());
  return names;
}

/// A temporary file is in the folder: the command is at work.
bool at_work(const std::string& folder) {
  for (const std::string& name : names_in(folder)) {
    if (name.starts_with(".")) return true;
  }
  return false;
}

/// A pipe that gives a text again and again until its reader has gone.
class EndlessPipe {
 public:
  EndlessPipe(const std::string& path, const std::string& text) {
    ::signal(SIGPIPE, SIG_IGN);
    ::mkfifo(path.c_str(), 0600);
    thread_ = std::thread([this, path, text] {
      const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);  // waits for the reader
      for (ssize_t n = 0; (n = ::write(fd, text.data(), text.size())) > 0;) taken_ += static_cast<std::size_t>(n);
      ::close(fd);
    });
  }
  ~EndlessPipe() {
    thread_.join();
    ::signal(SIGPIPE, SIG_DFL);
  }
  /// Bytes that the reader has taken by now, but for those that the pipe holds.
  std::size_t taken() const { return taken_; }

 private:
  std::atomic<std::size_t> taken_ = 0;
  std::thread thread_;
};

void expect_no_temporary(const std::string& folder) {
  EXPECT_FALSE(at_work(folder)) << ::testing::PrintToString(names_in(folder));
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Stop, SimulateLeavesTheLogAndTheTruthOfWhatWasDone) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const TempFolder folder;
    const CommandResult run = run_command({"simulate", "--duration", "5000", "--out", folder / "log.jsonl"}, "", signal,
                                          [&] { return at_work(folder.path()) && (::usleep(50'000), true); });
    EXPECT_EQ(run.code, code) << run.err;
    expect_no_temporary(folder.path());
    EXPECT_THAT(run.err, HasSubstr("stopped "));
    if (!fs::exists(folder / "log.jsonl")) continue;  // before the first scan
    EXPECT_EQ(lines_in(slurp(folder / "log.jsonl")), read_tum(folder / "log.jsonl.truth.tum").size());
  }
}

TEST(Stop, SimulatedPairsAndTheirAnswersAreWhole) {
  const TempFolder folder;
  const std::string pairs = folder / "pairs.jsonl", answers = folder / "answers";
  const CommandResult made = run_command({"simulate", "--pairs", "1000000", "--out", pairs}, "", SIGINT,
                                         [&] { return at_work(folder.path()) && (::usleep(300'000), true); });
  EXPECT_EQ(made.code, 130) << made.err;
  expect_no_temporary(folder.path());
  const std::string text = slurp(pairs);
  ASSERT_GT(lines_in(text), 0u) << made.err;
  std::string many;
  while (lines_in(many) < 2000) many += text;
  const CommandResult matched = run_command({"match", "--pairs", folder.put("many.jsonl", many)}, answers, SIGINT,
                                            [&] { return !slurp(answers).empty(); });
  EXPECT_EQ(matched.code, 130) << matched.err;
  EXPECT_THAT(matched.err, HasSubstr("stopped after "));
  const std::string lines = slurp(answers);
  EXPECT_TRUE(lines.ends_with("}\n"));
  EXPECT_LT(lines_in(lines), lines_in(many));
}

TEST(Stop, BenchWritesTheResultsOfWhatWasMatched) {
  const TempFolder folder;
  const CommandResult run =
      run_command({"bench", "--sim", "bench-sim", "--count", "1000000", "--out", folder / "out"}, "", SIGINT,
                  [&] { return fs::exists(folder / "out") && (::usleep(500'000), true); });
  EXPECT_EQ(run.code, 130) << run.err;
  expect_no_temporary(folder / "out");
  EXPECT_GT(json::parse(slurp(folder / "out/results.json"))["pairs"], 0);
}

TEST(Stop, PaperIsAllOrNothing) {
  const TempFolder folder;
  const CommandResult run = run_command({"paper", "--quick", "--out", folder / "out"}, "", SIGTERM,
                                        [&] { return fs::exists(folder / "out") && (::usleep(50'000), true); });
  EXPECT_EQ(run.code, 143) << run.err;
  EXPECT_THAT(names_in(folder / "out"), ::testing::IsEmpty());
}

TEST(Stop, ConvertAndInfoGiveWhatWasRead) {
  const TempFolder folder;
  std::string text;
  const std::string lap = testing::toy_log(200).flaser;
  for (int k = 0; k < 60; ++k) text += lap;
  const std::string log = folder.put("long.log", text);
  fs::create_directory(folder / "out");
  const CommandResult converted = run_command({"convert", log, folder / "out/log.jsonl"}, "", SIGINT,
                                              [&] { return at_work(folder / "out") && (::usleep(20'000), true); });
  EXPECT_EQ(converted.code, 130) << converted.err;
  expect_no_temporary(folder / "out");
  const std::string lines = slurp(folder / "out/log.jsonl");
  EXPECT_TRUE(lines.empty() || lines.ends_with("}\n"));

  // Beyond its first blocks it is at work, however slow the machine is.
  EndlessPipe pipe(folder / "pipe.log", lap);
  const CommandResult told =
      run_command({"info", folder / "pipe.log"}, "", SIGINT, [&] { return pipe.taken() > std::size_t{4} << 20; });
  EXPECT_EQ(told.code, 130) << told.err;
  EXPECT_THAT(told.err, HasSubstr("stopped after "));
  EXPECT_THAT(told.out, HasSubstr("scans "));
}

}  // namespace
}  // namespace phasescan::stop_test
