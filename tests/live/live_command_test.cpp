// What `live` says where there is nothing to listen to.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "support/command.hpp"

namespace phasescan::live_command_test {
namespace {

using test::CommandResult;
using test::run_command;

TEST(Live, NothingThereIsSaidInOneLine) {
  ::setenv("PHASESCAN_PORTS", "", 1);
  const CommandResult none = run_command({"live", "--port", "auto"});
  ::unsetenv("PHASESCAN_PORTS");
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
  const CommandResult missing = run_command({"live", "--port", "/dev/ttyUSB77", "--sensor", "ld06"});
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.err, ::testing::HasSubstr("plugged in"));
  EXPECT_EQ(run_command({"live"}).code, 2);
}

TEST(Live, TheListNamesEverySensor) {
  const CommandResult list = run_command({"live", "--list"});
  EXPECT_EQ(list.code, 0);
  for (const char* name :
       {"rplidar-a1", "ld06", "lds-01", "xv11", "ydlidar-x4", "camsense-x1", "delta-2b", "hokuyo", "sick-tim"})
    EXPECT_THAT(list.out, ::testing::HasSubstr(name));
}

TEST(Live, TheHelpNamesEveryFlag) {
  const CommandResult help = run_command({"live", "--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* flag : {"--port", "--replay", "--demo", "--sensor", "--json", "--raw", "--serve", "--folder",
                           "--health", "--list", "--ros2", "--record", "--save", "--resume", "--mask", "--config"})
    EXPECT_THAT(help.out, ::testing::HasSubstr(std::string(flag) + " ")) << flag;
}

TEST(Live, ALogThatIsReplayedGivesALineAScan) {
  const test::TempFolder folder;
  const std::string log = folder / "drive.jsonl";
  ASSERT_EQ(run_command({"simulate", "--world", "room", "--duration", "2", "--sensor", "ld06", "--out", log}).code, 0);
  const CommandResult run = run_command({"live", "--replay", log, "--json"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_GE(std::count(run.out.begin(), run.out.end(), '\n'), 15);
  EXPECT_THAT(run.out, ::testing::HasSubstr("latency_ms"));
}

/// The poses are those of `localize`, up to what the order of threads may change.
TEST(Live, OnAKnownMapTheRobotIsFound) {
  const test::TempFolder folder;
  const std::string log = folder / "drive.jsonl", whole = folder / "whole.jsonl";
  ASSERT_EQ(run_command({"simulate", "--world", "flat:3", "--duration", "20", "--sensor", "ld06", "--out", whole}).code,
            0);
  ASSERT_EQ(run_command({"convert", whole, log, "--to", "3"}).code, 0);
  ASSERT_EQ(run_command({"slam", whole, "--out", folder / "map", "--save", folder / "run.state"}).code, 0);
  for (const auto& known : {std::vector<std::string>{"--map", folder / "map/map.yaml"},
                            std::vector<std::string>{"--state", folder / "run.state"}}) {
    const CommandResult run = run_command(
        {"live", "--replay", log, "--json", "--serve", "off", "--record", folder / "out.mcap", known[0], known[1]});
    EXPECT_EQ(run.code, 0) << run.err;
    std::size_t ok = 0;
    for (std::size_t at = run.out.find("\"ok\""); at != std::string::npos; at = run.out.find("\"ok\"", at + 1)) ++ok;
    EXPECT_GE(ok, 20U) << run.out;
    EXPECT_THAT(run.out, ::testing::HasSubstr("hypotheses"));
  }
  EXPECT_EQ(run_command({"info", folder / "out.mcap"}).code, 0);
  EXPECT_EQ(run_command({"live", "--demo", "--map", "a.yaml", "--state", "b"}).code, 2);
  for (const char* other : {"--save", "--resume"}) {
    const CommandResult run = run_command({"live", "--demo", "--state", folder / "run.state", other, folder / "x"});
    EXPECT_EQ(run.code, 2) << other;
    EXPECT_THAT(run.err, ::testing::HasSubstr("--map"));
  }
  const CommandResult none = run_command({"live", "--demo", "--map", folder / "none.yaml"});
  EXPECT_EQ(none.code, 2);
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
}

}  // namespace
}  // namespace phasescan::live_command_test
