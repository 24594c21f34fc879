// The match, info and config commands from outside: exit codes, bytes, one clear line for what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/random.hpp"
#include "io/file.hpp"
#include "io/pairs.hpp"
#include "phasescan/io/scan_json.hpp"
#include "io/scan_log.hpp"
#include "support/command.hpp"
#include "support/data.hpp"

namespace phasescan::match_command_test {
namespace {

using nlohmann::json;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// An L-shaped room seen from T_room_sensor: no symmetry, every beam hits.
Scan room_scan(const Pose2& T_room_sensor) {
  const double corners[7][2] = {{-2, -1.5}, {3, -1.5}, {3, 1}, {1, 1}, {1, 2.5}, {-2, 2.5}, {-2, -1.5}};
  const double step = kTwoPi / 360;
  std::vector<float> raw(360);
  for (int k = 0; k < 360; ++k) {
    const double a = T_room_sensor.theta - kPi + k * step, c = std::cos(a), s = std::sin(a);
    double nearest = 100.0;
    for (int i = 0; i < 6; ++i) {
      const double px = corners[i][0] - T_room_sensor.x, py = corners[i][1] - T_room_sensor.y;
      const double ex = corners[i + 1][0] - corners[i][0], ey = corners[i + 1][1] - corners[i][1];
      const double det = c * -ey + s * ex;
      if (std::abs(det) < 1e-12) continue;
      const double range = (px * -ey + py * ex) / det, along = (c * py - s * px) / det;
      if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
    }
    raw[static_cast<std::size_t>(k)] = static_cast<float>(nearest);
  }
  return make_scan(raw, {-kPi, step, 0.15, 6.0});
}

ScanPair a_pair(int k) {
  Random random(static_cast<std::uint64_t>(k));
  const Pose2 a{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-1, 1)};
  const Pose2 b{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), a.theta + random.uniform(-0.3, 0.3)};
  ScanPair pair;
  pair.id = "pair-" + std::to_string(k);
  pair.dataset = "room";
  pair.cls = "small";
  pair.reference = room_scan(a);
  pair.scan = room_scan(b);
  pair.truth = a.inverse() * b;
  return pair;
}

std::string pairs_text(int count) {
  std::string text;
  for (int k = 0; k < count; ++k) text += format_pair(a_pair(k)) + "\n";
  return text;
}

std::vector<json> json_lines(const std::string& text) {
  std::vector<json> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(json::parse(line));
  return out;
}

// One line "phasescan: ..." that holds `what`, and nothing on standard output.
void expect_refusal(const test::CommandResult& result, int code, const std::string& what) {
  EXPECT_EQ(result.code, code) << result.err;
  EXPECT_THAT(result.err, StartsWith("phasescan: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr(what));
  EXPECT_EQ(result.out, "");
}

TEST(MatchCommand, TwoFilesGiveThePoseOfTheScanInTheReference) {
  const test::TempFolder folder;
  const ScanPair pair = a_pair(1);
  const auto result = run_command({"match", folder.put("a.json", format_scan_json(pair.reference)),
                                   folder.put("b.json", format_scan_json(pair.scan)), "--plot", folder / "f.svg"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json answer = json::parse(result.out);
  EXPECT_NEAR(answer.at("pose").at("x").get<double>(), pair.truth->x, 0.03);
  EXPECT_NEAR(answer.at("pose").at("y").get<double>(), pair.truth->y, 0.03);
  EXPECT_NEAR(answer.at("pose").at("theta").get<double>(), pair.truth->theta, 0.01);
  for (const char* key : {"method", "usable", "reason", "covariance", "confidence", "overlap", "ambiguous",
                          "alternatives", "rotation_source"}) {
    EXPECT_TRUE(answer.contains(key)) << key;
  }
  EXPECT_EQ(answer.at("covariance").size(), 9U);
  for (const char* key : {"total", "image", "missing", "rotation", "translation", "refine"})
    EXPECT_TRUE(answer.at("ms").contains(key)) << key;
  EXPECT_THAT(test::slurp(folder / "f.svg"), HasSubstr("</svg>"));
}

TEST(MatchCommand, AScanOfALogIsNamedByItsNumber) {
  const test::TempFolder folder;
  const ScanPair pair = a_pair(2);
  LogEntry first, second;
  first.scan = pair.reference;
  second.scan = pair.scan;
  const std::string log = folder.put("l.jsonl", format_log_line(first) + "\n" + format_log_line(second) + "\n");
  const auto result = run_command({"match", log + "#0", log + "#1", "--no-times"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NEAR(json::parse(result.out).at("pose").at("x").get<double>(), pair.truth->x, 0.03);
  EXPECT_FALSE(json::parse(result.out).contains("ms"));
  expect_refusal(run_command({"match", log + "#0", log + "#2"}), 2, "has 2 scans; expected more than 2 for #2");
  expect_refusal(run_command({"match", log + "#0", log + "#x"}), 2, "expected LOG#k");
  const std::string damaged = folder.put("d.jsonl", "rubbish {\n" + format_log_line(first) + "\n");
  EXPECT_EQ(run_command({"match", damaged + "#0", log + "#1"}).code, 4) << "the scan behind the rubbish can be read";
  const std::string partly = folder.put("p.jsonl", "{}\n" + format_log_line(first) + "\n");
  const auto warned = run_command({"match", partly + "#0", log + "#1"});
  EXPECT_EQ(warned.code, 4);
  EXPECT_THAT(warned.err, HasSubstr("p.jsonl:1: "));
}

TEST(MatchCommand, AnAnswerForEachPairInOrderAndTheSameBytesForAnyNumberOfThreads) {
  const test::TempFolder folder;
  const std::string pairs = folder.put("p.jsonl", pairs_text(50));
  for (const char* method : {"icp", "fft-icp2", "global"}) {
    const auto one = run_command({"match", "--pairs", pairs, "--method", method, "--no-times"});
    ASSERT_EQ(one.code, 0) << one.err;
    const auto answers = json_lines(one.out);
    ASSERT_EQ(answers.size(), 50U);
    for (int k = 0; k < 50; ++k)
      EXPECT_EQ(answers[static_cast<std::size_t>(k)].at("id").get<std::string>(), "pair-" + std::to_string(k));
    EXPECT_EQ(run_command({"match", "--pairs", pairs, "--method", method, "--no-times", "--threads", "3"}).out,
              one.out);
    EXPECT_EQ(run_command({"match", "--pairs", pairs, "--method", method, "--no-times"}).out, one.out);
  }
}

TEST(MatchCommand, ABadLineIsAnsweredInItsPlaceAndTheRestGoesOn) {
  const test::TempFolder folder;
  const std::string pairs = folder.put("p.jsonl", pairs_text(1) + "{\"id\": 7}\n" + pairs_text(1));
  const auto result = run_command({"match", "--pairs", pairs, "--no-times"});
  EXPECT_EQ(result.code, 2);
  const auto answers = json_lines(result.out);
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_TRUE(answers[0].contains("pose"));
  EXPECT_EQ(answers[1].at("line"), 2);
  EXPECT_THAT(answers[1].at("error").get<std::string>(), HasSubstr("\"reference\" is missing"));
  EXPECT_EQ(answers[2], answers[0]);
  EXPECT_THAT(result.err, StartsWith("phasescan: " + pairs + ":2: \"reference\" is missing"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  const auto worse =
      run_command({"match", "--pairs", folder.put("w.jsonl", "x\n" + pairs_text(1) + "y\nz\n"), "--no-times"});
  EXPECT_EQ(worse.code, 2);
  EXPECT_EQ(json_lines(worse.out).size(), 4U);
  EXPECT_THAT(worse.err,
              HasSubstr("w.jsonl:1: is not JSON at byte 1: 'x'; expected a JSON object; and 2 more bad lines"));
  EXPECT_EQ(std::count(worse.err.begin(), worse.err.end(), '\n'), 1) << worse.err;
}

TEST(MatchCommand, ACovarianceIsSymmetricToTheLastBit) {
  const test::TempFolder folder;
  const std::string pairs = folder.put("p.jsonl", pairs_text(30));
  for (const char* method : {"icp", "ndt", "fft", "fft-icp1", "fft-icp2", "global"}) {
    for (const json& answer : json_lines(run_command({"match", "--pairs", pairs, "--method", method}).out)) {
      const json& c = answer.at("covariance");
      EXPECT_EQ(c.at(1), c.at(3)) << method;
      EXPECT_EQ(c.at(2), c.at(6)) << method;
      EXPECT_EQ(c.at(5), c.at(7)) << method;
    }
  }
}

TEST(MatchCommand, LegalButHopelessScansAreNotUsableAndHoldNoNan) {
  const test::TempFolder folder;
  const auto scan = [&](const std::string& name, const std::string& ranges, const std::string& increment = "0.1") {
    return folder.put(name, "{\"angle_min\": 0, \"angle_increment\": " + increment +
                                ", \"range_max\": 6, \"ranges\": [" + ranges + "]}");
  };
  const std::string good = folder.put("good", format_scan_json(room_scan({})));
  std::string many = "1";
  for (int i = 0; i < 100; ++i) many += ",1e30";
  const std::vector<std::string> hopeless{
      scan("none", ""),        scan("missing", "0,0,0,null,NaN,-1,7,Infinity"), scan("one hit", "0,0,1.5,0,0"),
      scan("one beam", "1.5"), scan("one beam no increment", "1.5", "0"),       scan("wild", many)};
  for (const char* method : {"icp", "ndt", "fft", "fft-icp1", "fft-icp2", "global"}) {
    for (const auto& file : hopeless) {
      for (int side = 0; side < 3; ++side) {
        const std::string& reference = side == 0 ? good : file;
        const std::string& other = side == 1 ? good : file;
        const auto result = run_command({"match", reference, other, "--method", method, "--no-times"});
        EXPECT_EQ(result.code, 1) << method << " " << reference << " " << other << result.err;
        const json answer = json::parse(result.out);
        EXPECT_FALSE(answer.at("usable").get<bool>()) << result.out;
        EXPECT_NE(answer.at("reason"), "converged");
        for (const char* key : {"x", "y", "theta"}) EXPECT_TRUE(answer.at("pose").at(key).is_number()) << result.out;
        for (const auto& number : answer.at("covariance")) EXPECT_TRUE(number.is_number()) << result.out;
      }
    }
  }
}

TEST(MatchCommand, BadInputIsOneLineWithItsPlaceAndExitCode2) {
  const test::TempFolder folder;
  const std::string good = folder.put("good", format_scan_json(room_scan({})));
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& what) {
    const std::string file = folder.put(name, text);
    expect_refusal(run_command({"match", good, file}), 2, file + ":" + what);
    expect_refusal(run_command({"match", file, good}), 2, file + ":" + what);
  };
  refused("empty", "", "1: the file is empty");
  refused("truncated", "{\"angle_min\": 0,\n\"ranges\": [1,", "2: the JSON text is cut off");
  refused("brace too many", "{\"angle_min\": 0, \"angle_increment\": 0.1, \"ranges\": [1]}}",
          "1: is not JSON at byte 56");
  refused("word", "{\"angle_min\": 0, \"angle_increment\": 0.1,\n\"ranges\": [1, \"two\"]}",
          "2: \"ranges\"[1] is 'two'");
  refused("increment", "{\"angle_min\": 0,\n\"angle_increment\": 0, \"ranges\": [1, 2]}",
          "2: \"angle_increment\" is 0");
  refused("count", "{\"angles\": [0, 1, 2], \"ranges\": [1, 2]}", "1: \"angles\" has 3 entries");
  refused("gzip", std::string("\x1f\x8b\x08\x00", 4) + "rubbish rubbish", " gzip: the data is broken");
  refused("binary", std::string("\x00\x01\x02\x03", 4), "1: is not JSON");
  refused("carmen", "FLASER 1 1 0 0 0 0 0 0 1 h 1\n", "1: is not JSON");
  expect_refusal(run_command({"match", good, folder.path()}), 2, "is a folder");
  expect_refusal(run_command({"match", good, folder / "absent"}), 2, "no such file");
  expect_refusal(run_command({"match", "--pairs", folder.put("no pair", "\n\n")}), 2, "holds no pair");
  expect_refusal(run_command({"match", "--pairs", folder.path()}), 2, "is a folder");
}

TEST(MatchCommand, TenMillionBeamsAreRefusedInOneLine) {
  const test::TempFolder folder;
  std::string text = "{\"angle_min\": 0, \"angle_increment\": 1e-6, \"ranges\": [1";
  for (int i = 1; i < 10'000'000; ++i) text += ",1";
  const std::string file = folder.put("many", text + "]}");
  expect_refusal(run_command({"match", file, file}), 2, "\"ranges\" has 10000000 entries; expected at most 1000000");
}

TEST(MatchCommand, WrongUsageIsExitCode2) {
  const test::TempFolder folder;
  const std::string good = folder.put("good", format_scan_json(room_scan({})));
  expect_refusal(run_command({}), 2, "phasescan --help");
  expect_refusal(run_command({"match"}), 2, "expected two scans");
  expect_refusal(run_command({"match", good}), 2, "expected two scans");
  expect_refusal(run_command({"match", good, good, "--pairs", good}), 2, "expected two scans");
  expect_refusal(run_command({"match", good, good, "--method", "magic"}), 2, "--method: 'magic' is not one of icp");
  expect_refusal(run_command({"match", good, good, "--guess", "1,2"}), 2, "--guess: '1,2' is not 3 numbers");
  expect_refusal(run_command({"match", good, good, "--guess", "1,2,nan"}), 2, "--guess: ");
  expect_refusal(run_command({"match", good, good, "--threads", "0"}), 2, "--threads");
  expect_refusal(run_command({"match", good, good, "--nonsense"}), 2, "--nonsense");
  expect_refusal(run_command({"nonsense"}), 2, "nonsense");
  expect_refusal(run_command({"match", good, good, "--config", folder.put("c.yaml", "match:\n  fats: 1\n")}), 2,
                 "c.yaml:2: unknown option");
}

TEST(MatchCommand, WhatCannotBeWrittenIsExitCode3AndLeavesNothing) {
  const test::TempFolder folder;
  const std::string pairs = folder.put("p.jsonl", pairs_text(1));
  EXPECT_EQ(run_command({"match", "--pairs", pairs}, "/dev/full").code, 3);
  EXPECT_EQ(run_command({"config", "--dump"}, "/dev/full").code, 3);
  const std::string good = folder.put("good", format_scan_json(room_scan({})));
  expect_refusal(run_command({"match", good, good, "--plot", folder / "no/such/f.svg"}), 2,
                 "its folder does not exist");
  EXPECT_EQ(run_command({"match", good, good, "--plot", "/proc/f.svg"}).err.find("phasescan: "), 0U);
}

TEST(MatchCommand, TheMethodComesFromTheConfigurationUnlessAFlagSaysOtherwise) {
  const test::TempFolder folder;
  const std::string good = folder.put("good", format_scan_json(room_scan({})));
  const std::string config = folder.put("c.yaml", "match:\n  method: ndt\n");
  EXPECT_EQ(json::parse(run_command({"match", good, good, "--config", config}).out).at("method"), "ndt");
  EXPECT_EQ(json::parse(run_command({"match", good, good, "--config", config, "--method", "icp"}).out).at("method"),
            "icp");
}

TEST(ConfigCommand, TheDumpIsAConfigurationThatChangesNothing) {
  const test::TempFolder folder;
  const auto dump = run_command({"config", "--dump"});
  ASSERT_EQ(dump.code, 0);
  EXPECT_THAT(dump.out, HasSubstr("match:\n  method: "));
  EXPECT_EQ(run_command({"config", "--dump", "--config", folder.put("c.yaml", dump.out)}).out, dump.out);
  EXPECT_THAT(run_command({"config", "--dump", "icp"}).out, StartsWith("icp:\n"));
  expect_refusal(run_command({"config", "--dump", "nix"}), 2, "unknown section 'nix'");
}

TEST(InfoCommand, TellsWhatALogHoldsAndWhatIsWrong) {
  const test::TempFolder folder;
  LogEntry entry;
  entry.scan = room_scan({});
  std::string text;
  for (int k = 0; k < 10; ++k) {
    entry.scan.stamp = k * 100'000'000LL;
    text += format_log_line(entry) + "\n";
  }
  const auto clean = run_command({"info", folder.put("l", text)});
  EXPECT_EQ(clean.code, 0) << clean.err;
  EXPECT_THAT(clean.out, HasSubstr("10, 10 of them with a hit"));
  EXPECT_THAT(clean.out, HasSubstr("360 a scan"));
  EXPECT_THAT(clean.out, HasSubstr("10.00 scans/s"));
  const auto damaged = run_command({"info", folder.put("d", text + "{\"ranges\": [1, 2")});
  EXPECT_EQ(damaged.code, 4);
  EXPECT_THAT(damaged.out, HasSubstr("truncated line"));
  EXPECT_THAT(damaged.err, HasSubstr("d:11: "));
  EXPECT_EQ(run_command({"info", folder.put("hopeless", R"({"angle_min":0,"angle_increment":1,"ranges":[0,0]})")}).code,
            1);
  EXPECT_EQ(run_command({"info", folder.put("no scan", "PARAM a b\nSYNC x\n")}).code, 1);
  expect_refusal(run_command({"info", folder.put("empty", "")}), 2, "empty:1: the file is empty");
  expect_refusal(run_command({"info", folder.path()}), 2, "is a folder");
}

TEST(MatchCommand, AKnownSensorWidensTheCovariance) {
  const test::TempFolder folder;
  const std::string reference = folder.put("a.json", format_scan_json(room_scan({}))),
                    scan = folder.put("b.json", format_scan_json(room_scan({0.2, 0.1, 0.3})));
  const auto theta_variance = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"match", reference, scan};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run_command(words);
    EXPECT_EQ(result.code, 0) << result.err;
    return json::parse(result.out).at("covariance").at(8).get<double>();
  };
  const double turn = deg_to_rad(0.5);
  const std::string file = folder.put("turns.yaml", "beams: 360\nrevolution_turn_deg: 0.5\n");
  const double none = theta_variance({"--sensor", "rplidar-a1"}), known = theta_variance({"--sensor", file});
  EXPECT_NEAR(known - none, 2.0 * turn * turn, 1e-9) << "both scans turn";
  const double from_beams = theta_variance({});
  EXPECT_GT(from_beams, none);
  EXPECT_LT(from_beams, known);
  expect_refusal(run_command({"match", reference, scan, "--sensor", "rplidar-a9"}), 2, "rplidar-a9");
}

TEST(MatchCommand, EveryRecordedPairGetsALine) {
  if (test::recorded_data("pairs").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const char* name : {"fr079-180", "intel-360", "none-360", "rplidar-a1-16m-real"}) {
    const auto result = run_command(
        {"match", "--pairs", test::recorded_data(std::string("pairs/") + name + ".jsonl.gz"), "--no-times"});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 300) << name;
    EXPECT_EQ(result.out.find("null, \"covariance\""), std::string::npos);
  }
}

}  // namespace
}  // namespace phasescan::match_command_test
