// Logs that are wrong in every way a log can be, through the command: the exit code of the contract, one line a fault
// with file and line, never a crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/command.hpp"
#include "support/ros_fixture.hpp"

namespace phasescan::bad_log_test {
namespace {

using test::CommandResult;
using test::run_command;
using test::TempFolder;
using ::testing::HasSubstr;

std::string repeat(const std::string& text, std::size_t n) {
  std::string out;
  for (std::size_t i = 0; i < n; ++i) out += text;
  return out;
}

/// How a text format writes a log of one scan with these ranges; `beams` as it should be, in metres or as words.
struct Format {
  std::string name;
  std::size_t beams;
  std::function<std::string(const std::vector<std::string>&)> line;
  std::string head;     ///< lines before the first scan
  std::string no_scan;  ///< a file of this format without one
  bool any_count = false;
};

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : separator) + word;
  return out;
}

std::vector<Format> formats() {
  std::string breezy = "1";
  for (int i = 1; i < 24; ++i) breezy += " 1";
  return {
      {"carmen FLASER", 8, [](const auto& r) { return "FLASER 8 " + joined(r, " ") + " 0 0 0 0 0 0 1.5 h 1.5\n"; },
       "# CARMEN Logfile\n", "PARAM a 1\n"},
      {"carmen RAWLASER", 8,
       [](const auto& r) { return "RAWLASER1 0 -1.5 3 0.4 10 0.01 0 8 " + joined(r, " ") + " 0 1.5 h 1.5\n"; }, "",
       "ODOM 1 2 3 0 0 0 1 h 1\n"},
      {"carmen ROBOTLASER", 8,
       [](const auto& r) {
         return "ROBOTLASER1 0 -1.5 3 0.4 10 0.01 0 8 " + joined(r, " ") +
                " 0 1 2 0.5 1 2 0.4 0 0 0.5 0.5 0 1.5 h 1.5\n";
       },
       "", "SYNC a\n"},
      {"scan log", 8,
       [](const auto& r) {
         return R"({"angle_min": -1, "angle_increment": 0.2, "ranges": [)" + joined(r, ",") + "]}\n";
       },
       "", "", true},
      {"ticks", 360, [](const auto& r) { return "1 2 3 " + joined(r, " ") + "\n"; }, "", "# nothing\n"},
      {"breezy", 682, [breezy](const auto& r) { return breezy + " " + joined(r, " ") + " 7\n"; }, "", "# nothing\n"},
      {"csv", 8, [](const auto& r) { return "1.5," + joined(r, ",") + "\n"; }, "stamp_s,ranges_m\n",
       "stamp_s,ranges_m\n", true},
  };
}

CommandResult info_of(const TempFolder& folder, const std::string& content) {
  return run_command({"info", folder.put("log", content)});
}

/// Exit code, and that every line on stderr begins as it should; `place` must be among them.
void expect(const CommandResult& result, int code, const std::string& place) {
  EXPECT_EQ(result.code, code) << result.err;
  for (std::size_t at = 0; at < result.err.size(); at = result.err.find('\n', at) + 1)
    EXPECT_EQ(result.err.substr(at, 11), "phasescan: ") << result.err;
  EXPECT_THAT(result.err, HasSubstr(place));
  EXPECT_EQ(result.out.find("nan"), std::string::npos) << result.out;
}

TEST(BadLogs, EveryTextFormatNamesItsFaults) {
  for (const Format& format : formats()) {
    SCOPED_TRACE(format.name);
    const TempFolder folder;
    const bool millimetres = format.name == "ticks" || format.name == "breezy";
    const std::vector<std::string> good(format.beams, millimetres ? "1500" : "1.5");
    const auto with = [&](const std::string& word, std::size_t at = 3) {
      std::vector<std::string> words = good;
      words[at] = word;
      return words;
    };
    const long line = 1 + (format.head.empty() ? 0 : 1);
    const auto place = [&](long behind) { return "/log:" + std::to_string(line + behind) + ": "; };
    const std::string whole = format.head + format.line(good);
    expect(info_of(folder, whole), 0, "");

    expect(info_of(folder, ""), 2, "/log:1: the file is empty; expected a log");
    if (!format.no_scan.empty()) {
      EXPECT_THAT(info_of(folder, format.no_scan).code, testing::AnyOf(1, 2));
    }
    expect(info_of(folder, whole + format.line(with("rubbish"))), 4, place(1));
    if (!format.any_count) {
      std::vector<std::string> few = good;
      few.pop_back();
      expect(info_of(folder, whole + format.line(few)), 4, place(1));
    }
    const std::string line_text = format.line(good);
    expect(info_of(folder, whole + line_text.substr(0, line_text.size() / 2)), 4, place(1));
    // A scan that is legal but hopeless.
    expect(info_of(folder, format.head + format.line(std::vector<std::string>(format.beams, "0"))), 1,
           "no usable scan");
    std::vector<std::string> one(format.beams, "0");
    one[2] = good[2];
    expect(info_of(folder, format.head + format.line(one)), 0, "");
    // No distances: missing, or named; the scan before them is read either way.
    for (const char* word : {"nan", "inf", "-inf", "-1"}) {
      SCOPED_TRACE(word);
      const CommandResult result = info_of(folder, whole + format.line(with(word)));
      EXPECT_THAT(result.code, testing::AnyOf(0, 4)) << result.err;
      EXPECT_THAT(result.out, HasSubstr("scans "));
    }
    expect(info_of(folder, std::string("\x1f\x8b\x08\x00", 4) + whole), 2, "log");
  }
}

TEST(BadLogs, AnglesThatCannotBeAndBeamsBeyondCounting) {
  const TempFolder folder;
  const std::string scan = R"({"angle_min": 0, "angle_increment": 0.1, "ranges": [1, 2]})";
  for (const char* increment : {"0", "1e999", "\"x\"", "null"}) {
    const std::string bad =
        std::string(R"({"angle_min": 0, "angle_increment": )") + increment + R"(, "ranges": [1, 2]})";
    expect(info_of(folder, scan + "\n" + bad + "\n"), 4, "/log:2: ");
    expect(info_of(folder, bad + "\n"), 2, "/log:1: ");
  }
  expect(info_of(folder, "RAWLASER1 0 -1.5 0 0 10 0.01 0 3 1 2 3 0 1.5 h 1.5\n"), 2, "/log:1: ");
  expect(info_of(folder, "angle_min_rad,angle_increment_rad,ranges_m\n0,0,1,2\n0,0.1,1,2\n"), 4, "/log:2: ");

  constexpr std::size_t kTooMany = 10'000'000;
  expect(info_of(folder,
                 R"({"angle_min": 0, "angle_increment": 1e-6, "ranges": [1)" + repeat(",1", kTooMany - 1) + "]}\n"),
         2, "/log:1: ");
  expect(info_of(folder, "FLASER 10000000" + repeat(" 1", kTooMany) + " 0 0 0 0 0 0 1 h 1\n"), 2, "/log:1: ");
  const CommandResult polar = info_of(folder, "1, 2, 3" + repeat(", 1", kTooMany) + "\n");
  EXPECT_THAT(polar.code, testing::AnyOf(0, 2)) << polar.err;
}

TEST(BadLogs, RecordingsWithHopelessScans) {
  const TempFolder folder;
  const std::int64_t t = 1'600'000'000'000'000'000;
  const auto log = [&](const std::vector<float>& ranges, float increment_of = 0.0F) {
    std::string message = test::laser_scan(false, t, ranges);
    if (increment_of != 0.0F) {
      const float zero = 0.0F;
      message.replace(4 + 8 + 12 + 8, 4, std::string(reinterpret_cast<const char*>(&zero), 4));
    }
    return test::mcap({{"/scan", "sensor_msgs/msg/LaserScan", t, message}});
  };
  const auto code = [&](const std::string& bytes) {
    test::write_bytes(folder / "log", bytes);
    const CommandResult result = run_command({"info", folder / "log"});
    EXPECT_THAT(result.err, testing::AnyOf("", testing::StartsWith("phasescan: "))) << result.err;
    return result.code;
  };
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code(log({1, 2, 3})), 0);
  EXPECT_EQ(code(log({0, nan, inf, -1})), 1);
  EXPECT_EQ(code(log({0, 0, 1.5F, 0})), 0);
  EXPECT_THAT(code(log({1, 2, 3}, 1.0F)), testing::AnyOf(0, 2));  // increment 0: taken from the ends, or named
  EXPECT_EQ(code(test::mcap({})), 1);
  EXPECT_EQ(code(test::mcap({{"/scan", "sensor_msgs/msg/LaserScan", t, "too short"}})), 2);
  EXPECT_EQ(code(test::rosbag1({})), 1);
  test::rosbag2_sqlite(folder / "log", {});
  EXPECT_EQ(run_command({"info", folder / "log"}).code, 1);
  // A length of 4 GB in a message of a few bytes.
  std::string lie = test::laser_scan(false, t, {1, 2, 3});
  lie.replace(lie.size() - 4 * 4 - 4, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(code(test::mcap({{"/scan", "sensor_msgs/msg/LaserScan", t, lie}})), 2);
}

TEST(BadLogs, FoldersAndWhatIsNotThere) {
  const TempFolder folder;
  expect(run_command({"info", folder.path()}), 2, "is a folder without metadata.yaml");
  expect(run_command({"info", folder / "absent"}), 2, "no such file");
  expect(run_command({"info", ""}), 2, "expected");
  expect(run_command({"slam", folder / "absent", "--out", folder / "out"}), 2, "no such file");
  expect(run_command({"match", "--pairs", folder.path()}), 2, "is a folder");
  expect(run_command({"info", folder.put("rubbish", "lorem ipsum\n")}), 2, "rubbish:1: is of no known format");
  // Damage before any scan: nothing could be read.
  const std::string cut = folder.put("cut", "FLASER 3 1 2");
  for (const CommandResult& result : {run_command({"slam", cut, "--out", folder / "out"}), run_command({"info", cut}),
                                      run_command({"convert", cut, folder / "out.jsonl"})}) {
    expect(result, 2, "nothing in it could be read");
    EXPECT_THAT(result.err, testing::StartsWith("phasescan: " + cut + ":1: ")) << "one line with its place";
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST(BadLogs, AScanLogWithoutItsBeginningIsRead) {
  const TempFolder folder;
  const std::string line = R"({"angle_min": 0, "angle_increment": 0.1, "ranges": [1, 2, 3]})"
                           "\n";
  for (const std::string& head : {std::string("rubbish\n"), std::string(", 1.5, 2]}\n"), std::string("\0\0\n", 3)})
    expect(info_of(folder, head + line + line), 4, "/log:1: ");
}

}  // namespace
}  // namespace phasescan::bad_log_test
