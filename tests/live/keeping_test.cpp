// What `live` keeps: recordings that survive a kill and a full disk, and states that runs go on from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

#include "io/growing_file.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "phasescan/slam/state.hpp"
#include "support/command.hpp"

namespace phasescan::keeping_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::slurp;
using test::TempFolder;
using ::testing::HasSubstr;

std::string drive(const TempFolder& folder, const std::string& seconds) {
  const std::string log = folder / "drive.jsonl";
  EXPECT_EQ(run_command({"simulate", "--world", "room", "--duration", seconds, "--sensor", "ld06", "--out", log}).code,
            0);
  return log;
}

struct Read {
  std::vector<LogEntry> scans;
  std::size_t damages = 0;
};
Read read(const std::string& path) {
  const auto reader = open_log(path);
  Read out;
  while (auto entry = reader->next()) out.scans.push_back(std::move(*entry));
  out.damages = reader->damage_count();
  return out;
}

std::vector<double> stamps_of(const std::string& json_lines) {
  std::vector<double> out;
  std::istringstream text(json_lines);
  for (std::string line; std::getline(text, line);)
    if (line.ends_with("}")) out.push_back(nlohmann::json::parse(line)["stamp"]);
  return out;
}

/// Files of this process and its children may not grow beyond this.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST(Keeping, ARecordingHoldsTheScansAndTheStateTheRun) {
  const TempFolder folder;
  const std::string log = drive(folder, "2"), mcap = folder / "a.mcap", state = folder / "a.state";
  const CommandResult run = run_command({"live", "--replay", log, "--json", "--record", mcap, "--save", state});
  EXPECT_EQ(run.code, 0) << run.err;
  const Read source = read(log), recorded = read(mcap);
  EXPECT_EQ(recorded.damages, 0U);
  ASSERT_EQ(recorded.scans.size(), source.scans.size());
  for (std::size_t i = 0; i < source.scans.size(); ++i) {
    EXPECT_EQ(recorded.scans[i].scan.stamp, source.scans[i].scan.stamp);
    EXPECT_EQ(recorded.scans[i].scan.hit_count(), source.scans[i].scan.hit_count());
  }
  EXPECT_EQ(read_state(state).state.scans(), source.scans.size());
  const std::string about = run_command({"info", mcap}).out;
  for (const char* topic : {"/tf ", "/tf_static", "/map", "/path", "/pose", "/status", "/diagnostics"})
    EXPECT_THAT(about, HasSubstr(std::string("topic ") + topic));
}

TEST(Keeping, ARecordingIsNeverWrittenOver) {
  const TempFolder folder;
  const std::string log = drive(folder, "0.5"), mcap = folder / "a.mcap";
  std::ofstream(mcap) << "mine";
  const CommandResult run = run_command({"live", "--replay", log, "--record", mcap});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(slurp(mcap), "mine");
  EXPECT_THAT(run.err, HasSubstr("a-2.mcap"));
  EXPECT_EQ(read(folder / "a-2.mcap").damages, 0U);
  EXPECT_EQ(free_name(mcap), folder / "a-3.mcap");
  std::ofstream(folder / "a-3.mcap");  // an empty one is nobody's
  EXPECT_EQ(free_name(mcap), folder / "a-3.mcap");
  GrowingFile(folder / "a-3.mcap").write("x");
  EXPECT_EQ(free_name(mcap), folder / "a-4.mcap");
}

TEST(Keeping, AKillCostsTheLastSecondAtMost) {
  for (const int after_ms : {700, 1300, 1900}) {
    const TempFolder folder;
    const std::string log = drive(folder, "4"), mcap = folder / "a.mcap", state = folder / "a.state";
    const std::string out = folder / "lines";
    const auto begin = std::chrono::steady_clock::now();
    const CommandResult run =
        run_command({"live", "--replay", log, "--json", "--record", mcap, "--save", state}, out, SIGKILL,
                    [&] { return std::chrono::steady_clock::now() - begin > std::chrono::milliseconds(after_ms); });
    EXPECT_EQ(run.code, 128 + SIGKILL);
    const std::vector<double> shown = stamps_of(slurp(out));
    ASSERT_FALSE(shown.empty());
    const Read recorded = read(mcap);
    const double recorded_to =
        recorded.scans.empty() ? shown.front() : stamp_to_seconds(recorded.scans.back().scan.stamp);
    EXPECT_GE(recorded_to, shown.back() - 1.0) << "killed after " << after_ms << " ms";
    EXPECT_EQ(recorded.damages, 1U);  // that it has no end
    EXPECT_GT(read_state(state).state.scans(), 0U);
  }
}

TEST(Keeping, CtrlCClosesBoth) {
  const TempFolder folder;
  const std::string log = drive(folder, "4"), mcap = folder / "a.mcap", state = folder / "a.state";
  const std::string out = folder / "lines";
  const CommandResult run = run_command({"live", "--replay", log, "--json", "--record", mcap, "--save", state}, out,
                                        SIGINT, [&] { return stamps_of(slurp(out)).size() >= 8; });
  EXPECT_EQ(run.code, 130);
  const std::size_t shown = stamps_of(slurp(out)).size();
  EXPECT_LT(shown, 30U);
  const Read recorded = read(mcap);
  EXPECT_EQ(recorded.damages, 0U);
  EXPECT_EQ(recorded.scans.size(), shown);
  EXPECT_EQ(read_state(state).state.scans(), shown);
}

TEST(Keeping, WhereTheDiskIsFullTrackingGoesOn) {
  const TempFolder folder;
  const std::string log = drive(folder, "3"), mcap = folder / "a.mcap", state = folder / "a.state";
  CommandResult run;
  {
    const FileLimit limit(40'000);
    run = run_command({"live", "--replay", log, "--record", mcap, "--save", state});
  }
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("recording ends here, tracking goes on"));
  EXPECT_THAT(run.err, HasSubstr("the state is not saved"));
  EXPECT_THAT(run.err, HasSubstr("30 scans, 0 left out"));
  const Read recorded = read(mcap);
  EXPECT_GT(recorded.scans.size(), 3U);
  EXPECT_LT(recorded.scans.size(), 30U);
  EXPECT_EQ(recorded.damages, 1U);  // whole chunks, and no end
  // The file of the last time that there was room: whole.
  EXPECT_LT(read_state(state).state.scans(), 30U);
}

TEST(Keeping, AResumedRunGoesOnOrBeginsAnotherDrive) {
  const TempFolder folder;
  const std::string log = drive(folder, "3"), state = folder / "a.state", first = folder / "first.jsonl",
                    second = folder / "second.jsonl";
  std::istringstream lines(slurp(log));
  std::ofstream a(first), b(second);
  int k = 0;
  for (std::string line; std::getline(lines, line); ++k) (k < 15 ? a : b) << line << "\n";
  a.close();
  b.close();
  ASSERT_EQ(run_command({"live", "--replay", first, "--save", state}).code, 0);
  const CommandResult on = run_command({"live", "--replay", second, "--resume", state, "--save", state, "--json"});
  EXPECT_EQ(on.code, 0) << on.err;
  EXPECT_THAT(on.err, HasSubstr("goes on 0.1 s after"));
  EXPECT_EQ(summarize(read_state(state).state).drives, 1);
  EXPECT_EQ(read_state(state).state.scans(), static_cast<std::size_t>(k));
  // Tracked on, not begun anew at the origin.
  EXPECT_THAT(on.out, Not(HasSubstr("initialising")));
  const CommandResult other = run_command({"live", "--replay", first, "--resume", state, "--save", state});
  EXPECT_THAT(other.err, HasSubstr("another drive"));
  EXPECT_EQ(summarize(read_state(state).state).drives, 2);
  std::ofstream(state) << "no state";
  EXPECT_EQ(run_command({"live", "--replay", first, "--resume", state}).code, 2);
}

TEST(Keeping, WhatCannotBeWrittenIsSaidAtOnce) {
  const TempFolder folder;
  EXPECT_EQ(run_command({"live", "--demo", "--record", folder / "no/a.mcap"}).code, 2);
  EXPECT_EQ(run_command({"live", "--demo", "--save", folder / "no/a.state"}).code, 2);
}

TEST(GrowingFile, ARefusedPieceIsCutOffAgain) {
  const TempFolder folder;
  GrowingFile file(folder / "f");
  const FileLimit limit(1000);
  file.write(std::string(600, 'a'));
  EXPECT_THROW(file.write(std::string(600, 'b')), SystemError);
  EXPECT_EQ(slurp(folder / "f"), std::string(600, 'a'));
  file.write(std::string(300, 'c'));
  EXPECT_EQ(slurp(folder / "f"), std::string(600, 'a') + std::string(300, 'c'));
  EXPECT_THROW(GrowingFile(folder / "f"), SystemError);
  EXPECT_THROW(GrowingFile("/dev/null"), InputError);
}

}  // namespace
}  // namespace phasescan::keeping_test
