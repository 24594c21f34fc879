// The command `phasescan calibrate`, as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "io/file.hpp"
#include "sim/pairs_spec.hpp"
#include "support/paths.hpp"

namespace phasescan::calibrate_command_test {
namespace {

namespace fs = std::filesystem;

class CalibrateCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("phasescan-calibrate-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  int run_command(const std::string& flags) {
    const std::string command = test::command_path() + " " + flags + " > " + path("stdout") + " 2> " + path("stderr");
    const int status = std::system(command.c_str());
    const auto text = [&](const std::string& name) {
      return fs::file_size(path(name)) ? read_file(path(name)) : std::string();
    };
    out_ = text("stdout");
    said_ = text("stderr");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path folder_;
  std::string out_, said_;
};

TEST_F(CalibrateCommand, MeasuresWhatSimulateDidAndSimulateTakesIt) {
  ASSERT_EQ(run_command("simulate --world flat:3 --sensor rplidar-a1-real --stop-every 0.4 --stop-for 3 --duration 150 "
                        "--odometry --out " +
                        path("a.jsonl")),
            0)
      << said_;
  ASSERT_EQ(run_command("calibrate " + path("a.jsonl") + " --out " + path("s.yaml")), 0) << said_;
  EXPECT_THAT(out_, ::testing::HasSubstr("whole revolutions turn by"));
  const std::string once = read_file(path("s.yaml")), printed = out_;
  ASSERT_EQ(run_command("calibrate " + path("a.jsonl") + " --out " + path("s.yaml")), 0);
  EXPECT_EQ(read_file(path("s.yaml")), once);
  EXPECT_EQ(out_, printed);
  const sim::LidarOptions sensor = sim::read_lidar(path("s.yaml"));
  EXPECT_NEAR(sensor.effects.sample_rate_hz, 1924.0, 25.0);
  EXPECT_EQ(
      run_command("simulate --world flat:4 --sensor " + path("s.yaml") + " --duration 5 --out " + path("b.jsonl")), 0)
      << said_;
}

TEST_F(CalibrateCommand, SaysNoInOneLineWhereNothingStops) {
  ASSERT_EQ(run_command("simulate --world flat:3 --sensor ld06 --path circle --duration 15 --out " + path("a.jsonl")),
            0)
      << said_;
  EXPECT_EQ(run_command("calibrate " + path("a.jsonl") + " --out " + path("s.yaml")), 1);
  EXPECT_THAT(said_, ::testing::MatchesRegex("phasescan: [^\n]*holds no stop[^\n]*\n"));
  EXPECT_FALSE(fs::exists(path("s.yaml")));
}

TEST_F(CalibrateCommand, BadInputIsOneLine) {
  write_file(path("rubbish"), "this is no log\n");
  for (const std::string& flags : std::vector<std::string>{"no-such-log --out x", path("rubbish") + " --out x", "",
                                                           path("rubbish"), path("rubbish") + " --out"}) {
    EXPECT_EQ(run_command("calibrate " + flags), 2) << flags;
    EXPECT_THAT(said_, ::testing::MatchesRegex("phasescan: [^\n]+\n")) << flags;
  }
}

}  // namespace
}  // namespace phasescan::calibrate_command_test
