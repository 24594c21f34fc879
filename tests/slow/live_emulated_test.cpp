// Whole runs: an emulated sensor on a pseudo-terminal or a TCP port, `live` at the other end, poses against the truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <future>
#include <optional>
#include <sstream>
#include <thread>

#include "io/tum.hpp"
#include "support/command.hpp"

namespace phasescan::live_emulated_test {
namespace {

using nlohmann::json;
using test::CommandResult;
using test::run_command;
using test::slurp;
using test::TempFolder;

struct LiveRun {
  CommandResult emulator, live;
  std::vector<json> lines;
  std::vector<StampedPose> truth;
};

/// Emulates a sensor for a drive of `seconds`, and lets `live` listen until it is over.
LiveRun run(const std::string& sensor, int seconds, std::vector<std::string> faults = {},
            std::vector<std::string> more = {}) {
  const TempFolder folder;
  const std::string port_file = folder / "port", truth = folder / "truth.tum";
  std::vector<std::string> emulate = {
      "emulate", "--sensor", sensor, "--world", "flat", "--duration", std::to_string(seconds), "--truth", truth};
  emulate.insert(emulate.end(), faults.begin(), faults.end());
  auto emulator = std::async(std::launch::async, [&] { return run_command(emulate, port_file); });
  std::string port;
  for (int i = 0; i < 500 && !port.ends_with("\n"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    port = slurp(port_file);
  }
  port.resize(port.find('\n'));
  std::vector<std::string> live = {"live", "--port", port, "--json"};
  live.insert(live.end(), more.begin(), more.end());
  LiveRun out;
  out.live = run_command(live, "", SIGINT,
                         [&] { return emulator.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
  out.emulator = emulator.get();
  std::istringstream text(out.live.out);
  for (std::string line; std::getline(text, line);) out.lines.push_back(json::parse(line));
  out.truth = read_tum(truth);
  return out;
}

/// Distance from the truth, root mean square, in the frame of the first pose [m].
double rms_error(const LiveRun& run) {
  double sum = 0.0;
  int count = 0;
  std::optional<Pose2> T_truth_live;
  for (const json& line : run.lines) {
    const Stamp stamp = stamp_from_seconds(line["stamp"]);
    std::size_t i = 1;
    while (i < run.truth.size() && run.truth[i].stamp < stamp) ++i;
    if (i >= run.truth.size() || stamp < run.truth.front().stamp) continue;
    const StampedPose &a = run.truth[i - 1], &b = run.truth[i];
    const double share = static_cast<double>(stamp - a.stamp) / static_cast<double>(b.stamp - a.stamp);
    const Pose2 truth{a.pose.x + share * (b.pose.x - a.pose.x), a.pose.y + share * (b.pose.y - a.pose.y),
                      a.pose.theta + share * wrap_angle(b.pose.theta - a.pose.theta)};
    const Pose2 live{line["pose"]["x"], line["pose"]["y"], line["pose"]["theta"]};
    if (!T_truth_live) T_truth_live = truth * live.inverse();
    sum += (truth.translation() - (*T_truth_live * live).translation()).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 1.0;
}

TEST(Emulated, APseudoTerminalGivesTheWayOfTheSensor) {
  const LiveRun got = run("ld06", 6, {}, {"--sensor", "ld06"});
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_EQ(got.emulator.code, 0) << got.emulator.err;
  EXPECT_GT(got.lines.size(), 50U);
  EXPECT_LT(rms_error(got), 0.03);
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("closed at the other end"));
}

TEST(Emulated, DatagramsGiveTheWayAsWell) {
  const LiveRun got = run("rplidar-t1", 6, {}, {"--sensor", "rplidar-t1"});
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("udp:127.0.0.1:"));
  EXPECT_GT(got.lines.size(), 40U);
  EXPECT_LT(rms_error(got), 0.03);
}

TEST(Emulated, TheSensorIsFoundByAsking) {
  const LiveRun got = run("rplidar-a1", 8);
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("Slamtec RPLIDAR A1"));
  EXPECT_GT(got.lines.size(), 15U) << got.live.err;
  EXPECT_LT(rms_error(got), 0.03);
}

TEST(Emulated, ASensorOfTheOtherFamilyThatAnswersAlikeIsFoundByAsking) {
  const LiveRun got = run("ydlidar-x4", 6);
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("YDLIDAR X4"));
  EXPECT_GT(got.lines.size(), 15U) << got.live.err;
  EXPECT_LT(rms_error(got), 0.03);
}

TEST(Emulated, UnpluggedItGoesOnWhenItIsBack) {
  const TempFolder folder;
  const std::string name = folder / "lidar";
  const LiveRun got =
      run("ld06", 7, {"--link", name, "--unplug-at", "2.5", "--replug-after", "1"}, {"--sensor", "ld06"});
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("there again"));
  ASSERT_GT(got.lines.size(), 30U);
  const double first = got.lines.front()["stamp"], last = got.lines.back()["stamp"];
  EXPECT_GT(last - first, 4.5);
}

TEST(Emulated, StallsThatComeAgainCostNoMoreThanTheirTime) {
  const LiveRun got =
      run("ld06", 9, {"--stall-at", "2", "--stall-for", "1", "--fault-every", "3"}, {"--sensor", "ld06"});
  int stalls = 0;
  for (std::size_t i = 1; i < got.lines.size(); ++i) {
    const double gap = double{got.lines[i]["stamp"]} - double{got.lines[i - 1]["stamp"]};
    stalls += gap > 0.9 ? 1 : 0;
    EXPECT_LT(gap, 3.0);
  }
  EXPECT_GE(stalls, 2);  // the third may outlast the run
  EXPECT_LT(rms_error(got), 0.03);
}

TEST(Emulated, RecordedBytesGiveTheSameScansAtTheirPace) {
  const TempFolder folder;
  const std::string raw = folder / "ld06.raw";
  const LiveRun got = run("ld06", 4, {}, {"--sensor", "ld06", "--raw", raw});
  ASSERT_GT(got.lines.size(), 25U);
  const auto begin = std::chrono::steady_clock::now();
  const CommandResult again = run_command({"live", "--port", raw, "--json"});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(again.code, 0) << again.err;
  std::vector<json> lines;
  std::istringstream text(again.out);
  for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line));
  EXPECT_EQ(lines.size(), got.lines.size());
  const double lasted = double{got.lines.back()["stamp"]} - double{got.lines.front()["stamp"]};
  EXPECT_GT(took.count(), lasted);
  EXPECT_LT(took.count(), lasted + 3.0);
  // Same bytes at the same pace: the way is the same, though a match may have come at another moment.
  for (std::size_t i = 0; i < std::min(lines.size(), got.lines.size()); ++i)
    EXPECT_NEAR(double{lines[i]["pose"]["x"]}, double{got.lines[i]["pose"]["x"]}, 0.03);
}

TEST(Emulated, DamagedBytesCostScansNotPoses) {
  const LiveRun got = run("ld06", 6, {"--corrupt", "0.001", "--drop", "0.0005"}, {"--sensor", "ld06"});
  EXPECT_GT(got.lines.size(), 40U) << got.live.err;
  EXPECT_LT(rms_error(got), 0.03);
}

/// One byte in a hundred is wrong: short packets bring poses as ever.
TEST(Emulated, ABadLineCostsShortPacketsNoPose) {
  const LiveRun got = run("ld06", 6, {"--corrupt", "0.01"}, {"--sensor", "ld06"});
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_GT(got.lines.size(), 40U) << got.live.err;
  EXPECT_LT(rms_error(got), 0.03);
}

/// Of packets of 84 bytes more than half are damaged: that is said, and nothing wrong is claimed.
TEST(Emulated, ABadLineOfLongPacketsIsStatedAndNoPoseIsCalledOk) {
  const LiveRun got = run("rplidar-a1", 10, {"--corrupt", "0.01"}, {"--sensor", "rplidar-a1"});
  EXPECT_EQ(got.live.code, 130) << got.live.err;
  EXPECT_THAT(got.live.err, ::testing::HasSubstr("% of the beams are lost; no pose is called ok"));
  std::size_t ok = 0;
  for (const json& line : got.lines) ok += line["status"] == "ok";
  EXPECT_LE(ok, 1U);  // the first one, before it is known how many are lost
}

TEST(Emulated, ASensorOverTcp) {
  const LiveRun got = run("sick-tim", 5, {}, {"--sensor", "sick-tim"});
  EXPECT_GT(got.lines.size(), 50U) << got.live.err;
  EXPECT_LT(rms_error(got), 0.03);
}

}  // namespace
}  // namespace phasescan::live_emulated_test
