// What of a log is read, and what is said of a text that does not say it: the flags of info, convert and slam.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/command.hpp"
#include "support/temp.hpp"

namespace phasescan::log_flags_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::TempFolder;
using ::testing::HasSubstr;

std::string numbers(int rows, int columns) {
  std::string text;
  for (int k = 0; k < rows; ++k) {
    text += std::to_string(1000 + 100 * k);
    for (int i = 1; i < columns; ++i) text += " " + std::to_string(2000 + 10 * i);
    text += '\n';
  }
  return text;
}

void expect_refusal(const std::vector<std::string>& arguments, const std::string& said) {
  const CommandResult result = run_command(arguments);
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_THAT(result.err, HasSubstr(said));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

std::vector<nlohmann::json> converted(const TempFolder& folder, std::vector<std::string> flags, int code = 0) {
  flags.insert(flags.begin(), {"convert", folder / "log.txt", folder / "out.jsonl"});
  const CommandResult result = run_command(flags);
  EXPECT_EQ(result.code, code) << result.err;
  std::vector<nlohmann::json> scans;
  std::ifstream file(folder / "out.jsonl");
  for (std::string line; std::getline(file, line);) scans.push_back(nlohmann::json::parse(line));
  return scans;
}

TEST(LogFlags, NumbersAloneAreRefusedWithWhatToType) {
  const TempFolder folder;
  folder.put("log.txt", numbers(5, 182));
  expect_refusal({"info", folder / "log.txt"}, "182 numbers a line and no header; expected --columns");
  expect_refusal({"slam", folder / "log.txt", "--out", folder / "out"}, "expected --columns");
}

TEST(LogFlags, GeometryUnitsAndCutsComeFromFlags) {
  const TempFolder folder;
  folder.put("log.txt", numbers(5, 182));
  auto scans = converted(folder, {"--columns", "stamp,ranges_mm", "--stamp-unit", "ms", "--fov", "180", "--from",
                                  "0.15", "--to", "0.35", "--range-max", "3", "--mask", "-10:10", "--clockwise"});
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_NEAR(scans[0]["angle_min"].get<double>(), M_PI / 2, 1e-9);
  EXPECT_NEAR(scans[0]["angle_increment"].get<double>(), -M_PI / 180, 1e-9);
  EXPECT_NEAR(scans[0]["stamp"].get<double>(), 1.2, 1e-9);
  EXPECT_EQ(scans[0]["range_max"].get<double>(), 3.0);
  EXPECT_TRUE(scans[0]["ranges"][90].is_null()) << "ahead, in the mask";
  EXPECT_EQ(scans[0]["ranges"][180].get<double>(), 4.0) << "out of range: range_max + 1";
  EXPECT_FLOAT_EQ(scans[0]["ranges"][0].get<float>(), 2.01F);
}

TEST(LogFlags, AReplayAndACalibrationEndWhereToSays) {
  const TempFolder folder;
  folder.put("log.txt", numbers(5, 182));
  const std::vector<std::string> shape{"--columns", "stamp_ms,ranges_mm", "--fov", "180", "--from", "0.05", "--to",
                                       "0.25"};
  std::vector<std::string> live{"live", "--replay", folder / "log.txt", "--serve", "off", "--json"};
  live.insert(live.end(), shape.begin(), shape.end());
  const CommandResult replay = run_command(live);
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_EQ(std::count(replay.out.begin(), replay.out.end(), '\n'), 2) << replay.out;
  std::vector<std::string> calibrate{"calibrate", folder / "log.txt", "--out", folder / "sensor.yaml"};
  calibrate.insert(calibrate.end(), shape.begin(), shape.end());
  EXPECT_EQ(run_command(calibrate).code, 1) << "it ran: two scans are too few";
}

TEST(LogFlags, FlagsThatCannotHoldForALogAreRefused) {
  const TempFolder folder;
  const std::string log = folder.put("log.jsonl", R"({"angle_min":0,"angle_increment":0.1,"ranges":[1,2,3],"stamp":1})"
                                                  "\n");
  for (const auto& [flags, said] :
       {std::pair<std::vector<std::string>, std::string>{{"--frame", "laser"}, "no --frame"},
        {{"--topic", "/scan"}, "no --topic"},
        {{"--range-min", "5", "--range-max", "3"}, "not below --range-max"},
        {{"--from", "5", "--to", "3"}, "is after --to"}}) {
    std::vector<std::string> words{"convert", log, folder / "out.jsonl"};
    words.insert(words.end(), flags.begin(), flags.end());
    expect_refusal(words, said);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.jsonl")) << said;
  }
  EXPECT_EQ(run_command({"convert", log, folder / "out.jsonl", "--range-min", "1", "--range-max", "3"}).code, 0);
}

TEST(LogFlags, ARecordingIsNeverWrittenOver) {
  const TempFolder folder;
  const std::string text = R"({"angle_min":0,"angle_increment":0.1,"ranges":[1,2,3],"stamp":1})";
  const std::string log = folder.put("log.jsonl", text + "\n");
  expect_refusal({"convert", log, log, "--range-max", "2"}, "is the log itself");
  expect_refusal({"convert", log, folder.path() + "/./log.jsonl"}, "is the log itself");
  expect_refusal({"calibrate", log, "--out", log}, "is the log itself");
  EXPECT_EQ(test::slurp(log), text + "\n");
}

TEST(LogFlags, WhatWasAssumedIsSaid) {
  const TempFolder folder;
  folder.put("log.txt", numbers(5, 182));
  const CommandResult slam = run_command(
      {"slam", folder / "log.txt", "--columns", "stamp_ms,ranges_mm", "--out", folder / "out", "--no-times"});
  EXPECT_THAT(slam.err, HasSubstr("the file states no angles: taken as a full turn from 0, counter-clockwise; --fov"));
  const CommandResult info = run_command({"info", folder / "log.txt", "--columns", "stamp_ms,ranges_mm"});
  EXPECT_THAT(info.out, HasSubstr("finding: assumed angles"));
}

TEST(LogFlags, MistakesAreOneLine) {
  const TempFolder folder;
  folder.put("log.txt", numbers(5, 182));
  const std::string log = folder / "log.txt";
  const auto with = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"info", log, "--columns", "stamp_ms,ranges_mm"});
    return flags;
  };
  expect_refusal(with({"--fov", "400"}), "--fov");
  expect_refusal(with({"--mask", "20"}), "'20' is no sector; expected FROM:TO in degrees");
  expect_refusal(with({"--stamp-unit", "h"}), "--stamp-unit");
  expect_refusal(with({"--range-min", "-1"}), "--range-min");
  expect_refusal(with({"--fov", "180", "--angle-increment", "0.5"}), "contradict each other for 181 beams");
  const std::string json = folder.put("a.jsonl", "{\"angle_min\": 0, \"angle_increment\": 0.1, \"ranges\": [1, 2]}\n");
  expect_refusal({"info", json, "--fov", "180"}, "states its own angles and times");
}

}  // namespace
}  // namespace phasescan::log_flags_test
