// slam on logs that are odd rather than cut: two lasers, beams that come and go, odometry that jumps, Ctrl-C.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "output/map_file.hpp"
#include "io/tum.hpp"
#include "support/command.hpp"
#include "support/toy_log.hpp"

namespace phasescan::slam_odd_logs_test {
namespace {

using nlohmann::json;
using test::run_command;
using test::slurp;
using test::TempFolder;
using testing::lines_of;
using testing::toy_log;

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// Runs slam and checks what every run promises: as many poses as scans, a map, a report; gives the summary.
json slam_summary(const TempFolder& folder, const std::string& text, std::size_t scans, int code,
                  const std::vector<std::string>& more = {"--odometry", "none"}) {
  std::vector<std::string> arguments = {"slam", folder.put("odd.log", text), "--out", folder / "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const auto run = run_command(arguments);
  EXPECT_EQ(run.code, code) << run.err;
  EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), scans);
  const TrinaryMap map = read_map(folder / "out/map.yaml");
  EXPECT_GT(std::count(map.cells.begin(), map.cells.end(), CellState::kFree), 5000);
  return json::parse(slurp(folder / "out/summary.json"));
}

double ate_rmse(const TempFolder& folder, const std::string& truth) {
  const auto eval = run_command({"eval", "--trajectory", folder / "out/trajectory.tum", "--reference",
                                 folder.put("truth.tum", truth), "--max-gap", "0.01", "--json"});
  EXPECT_EQ(eval.code, 0) << eval.err;
  return json::parse(eval.out)["ate_m"]["rmse"];
}

TEST(SlamOddLogs, TwoLasersMakeOneMap) {
  const TempFolder folder;
  const auto log = toy_log(150);
  std::string text;
  std::size_t scans = 0;
  for (const std::string& line : lines_of(log.flaser)) {
    text += line;
    ++scans;
    // Every other scan comes from a second laser with half the beams as well.
    if (scans % 2 == 0) continue;
    const auto words = words_of(line);
    std::string ranges;
    for (std::size_t k = 2; k < 362; k += 2) ranges += " " + words[k];
    text += "RAWLASER2 0 -1.570796 3.141593 0.01745329 80 0.01 0 180" + ranges + " 0 " + words[words.size() - 3] +
            " host " + words.back() + "\n";
  }
  const json summary = slam_summary(folder, text, scans + (scans + 1) / 2, 0);
  EXPECT_EQ(summary["warnings"]["several lasers"], 1) << summary["warnings"];
  EXPECT_LT(ate_rmse(folder, log.truth), 0.03);
}

TEST(SlamOddLogs, BeamsThatComeAndGoAreCounted) {
  const TempFolder folder;
  const auto log = toy_log(150);
  std::string text;
  std::size_t number = 0;
  for (const std::string& line : lines_of(log.flaser)) {
    if (number++ % 3 != 0) {
      text += line;
      continue;
    }
    auto words = words_of(line);
    std::string shorter = "FLASER 180";
    for (std::size_t k = 2; k < 362; k += 2) shorter += " " + words[k];
    for (std::size_t k = 362; k < words.size(); ++k) shorter += " " + words[k];
    text += shorter + "\n";
  }
  const json summary = slam_summary(folder, text, 150, 0);
  EXPECT_EQ(summary["warnings"]["beam count changes"], 99) << summary["warnings"];
  EXPECT_LT(ate_rmse(folder, log.truth), 0.03);
}

TEST(SlamOddLogs, OdometryThatJumpsIsDamageAndNotFollowed) {
  const TempFolder folder;
  const auto log = toy_log(150);
  std::string text;
  std::size_t number = 0;
  for (const std::string& line : lines_of(log.flaser)) {
    auto words = words_of(line);
    if (number++ >= 75) words[365] = std::to_string(std::stod(words[365]) + 12.0);
    std::string moved;
    for (const std::string& word : words) moved += word + " ";
    text += moved + "\n";
  }
  const json summary = slam_summary(folder, text, 150, 4, {});
  EXPECT_TRUE(summary["odometry"]["used"]);
  EXPECT_EQ(summary["warnings"]["odometry jump"], 1) << summary["warnings"];
  EXPECT_EQ(summary["odometry"]["jumped"], 1);
  EXPECT_LT(ate_rmse(folder, log.truth), 0.03);
}

TEST(SlamOddLogs, OdometryThatBeginsLateIsUsed) {
  const TempFolder folder;
  const auto converted = run_command({"convert", folder.put("in.log", toy_log(150).flaser), folder / "all.jsonl"});
  ASSERT_EQ(converted.code, 0) << converted.err;
  std::string text;
  std::size_t number = 0;
  for (const std::string& line : lines_of(slurp(folder / "all.jsonl"))) {
    json scan = json::parse(line);
    if (number++ < 80) scan.erase("odometry");
    text += scan.dump() + "\n";
  }
  const json summary = slam_summary(folder, text, 150, 0, {});
  EXPECT_TRUE(summary["odometry"]["used"]) << summary["odometry"];
  EXPECT_EQ(summary["odometry"]["steps"], 69);
}

TEST(SlamOddLogs, WheelsThatAreSwitchedOffAreNotSaidToBeUsed) {
  const TempFolder folder;
  const json summary = slam_summary(folder, toy_log(60).flaser, 60, 0,
                                    {"--config", folder.put("c.yaml", "odometry:\n  use_wheels: false\n")});
  EXPECT_FALSE(summary["odometry"]["used"]) << summary["odometry"];
}

TEST(SlamOddLogs, ANameThatIsNoUtf8IsNoReasonToFail) {
  const TempFolder folder;
  const auto run = run_command({"slam", folder.put("a\xff.log", toy_log(60).flaser), "--out", folder / "out"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(json::parse(slurp(folder / "out/summary.json"))["scans"], 60);
}

TEST(SlamOddLogs, CtrlCWritesWhatIsDone) {
  const TempFolder folder;
  const auto log = toy_log(150);
  std::string text;
  for (int lap = 0; lap < 40; ++lap) text += log.flaser;
  bool seen = false;
  const auto run = run_command({"slam", folder.put("long.log", text), "--out", folder / "out", "--odometry", "none"},
                               "", SIGINT, [&] {
                                 // The folder is there just before the first scan is read.
                                 if (!seen) return seen = std::filesystem::exists(folder / "out"), false;
                                 ::usleep(50'000);
                                 return true;
                               });
  EXPECT_EQ(run.code, 130) << run.err;
  const json summary = json::parse(slurp(folder / "out/summary.json"));
  EXPECT_FALSE(summary["complete"]);
  EXPECT_NE(run.err.find("stopped after " + summary["scans"].dump() + " scans"), std::string::npos) << run.err;
  EXPECT_LT(summary["scans"], 40 * 150);
  EXPECT_EQ(read_tum(folder / "out/trajectory.tum").size(), summary["scans"]);
  EXPECT_GT(read_map(folder / "out/map.yaml").cells.size(), 1000u);
  EXPECT_NE(slurp(folder / "out/report.html").find("</html>"), std::string::npos);
}

}  // namespace
}  // namespace phasescan::slam_odd_logs_test
