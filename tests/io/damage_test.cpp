// Every format, made small: cut beside every record border and at 200 places, bits flipped at 200.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "io/file.hpp"
#include "io/scan_log.hpp"
#include "support/damage.hpp"

namespace phasescan::damage_test {
namespace {

using namespace test;

constexpr std::int64_t kStart = 1'600'000'000'000'000'000;
constexpr std::size_t kPlaces = 200;

std::vector<float> ranges_of(int k, std::size_t n) {
  std::vector<float> out(n);
  for (std::size_t i = 0; i < n; ++i)
    out[i] = i % 9 == 4 ? 0.0F : 1.0F + 0.01F * static_cast<float>((static_cast<std::size_t>(k) * 37 + i * 13) % 200);
  return out;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f", value);
  return text;
}

/// `head`, the ranges and `tail`, `scans` times; `scale` makes millimetres of metres.
std::string lines(int scans, std::size_t beams, const std::function<std::string(int)>& head,
                  const std::string& separator, const std::string& tail, double scale = 1.0) {
  std::string out;
  for (int k = 0; k < scans; ++k) {
    out += head(k);
    for (const float range : ranges_of(k, beams)) {
      const double value = range * scale;
      out += separator + (scale == 1.0 ? number(value) : std::to_string(std::lround(value)));
    }
    out += tail + "\n";
  }
  return out;
}

struct TextFile {
  std::string name, text;
  LogOptions options;
  bool beams = false;       ///< a beam a line
  bool open_end = false;    ///< a last number that was cut off is a number still
  std::size_t told_by = 1;  ///< lines that must be there to tell the format
};

/// Before the format can be told nothing is read.
void expect_scans_once_told(Sample& sample, std::size_t lines) {
  sample.scans_before = [scans = sample.scans_before, lines](std::size_t n) {
    const std::size_t before = scans(n);
    return before < lines ? 0 : before;
  };
}

std::vector<TextFile> text_files() {
  const auto stamp = [](int k) { return std::to_string(1'600'000'000 + k) + ".25"; };
  std::vector<TextFile> out;
  out.push_back({"carmen FLASER",
                 "PARAM robot_frontlaser_offset 0.1\n" +
                     lines(
                         12, 60, [](int) { return "FLASER 60"; }, " ", " 1 2 0.5 1 2 0.6 1600000000.25 host 0.5"),
                 {}});
  out.push_back({"carmen of seconds and microseconds",
                 lines(
                     12, 60, [](int) { return "FLASER 60"; }, " ", " 1 2 0.5 1 2 0.6 1600000000 host 250000"),
                 {}});
  out.push_back({"carmen ROBOTLASER1",
                 lines(
                     12, 60, [](int) { return "ROBOTLASER1 0 -1.57 3.14 0.05 20 0.01 0 60"; }, " ",
                     " 0 1 2 0.5 1 2 0.4 0 0 0.5 0.5 0 1600000000.5 host 0.7"),
                 {}});
  std::string scan_log;
  for (int k = 0; k < 12; ++k) {
    LogEntry entry;
    entry.scan = make_scan(ranges_of(k, 60), {-1.5, 0.05, 0.1, 6.0});
    entry.scan.stamp = kStart + k * Stamp{100'000'000};
    entry.odometry = Pose2{0.1 * k, 0, 0};
    scan_log += format_log_line(entry) + "\n";
  }
  out.push_back({"scan log", scan_log, {}});
  out.push_back(
      {"ticks",
       lines(
           8, 360,
           [](int k) { return std::to_string(5 * k) + " " + std::to_string(6 * k) + " 18" + std::to_string(k); }, " ",
           "", 1000.0),
       {},
       false,
       true});
  out.push_back({"breezy",
                 lines(
                     6, 682,
                     [](int k) {
                       std::string head = std::to_string(100'000 * k);
                       for (int i = 1; i < 24; ++i) head += " " + std::to_string(i);
                       return head;
                     },
                     " ", " 7", 1000.0),
                 {}});
  std::string polar;  // its sensor never gives the same number of ranges for long
  for (std::size_t k = 0; k < 10; ++k) {
    polar += lines(
        1, 88 + k % 4, [](int) { return "1.5, 2.5, 0.1"; }, ", ", "");
  }
  out.push_back({"polar", polar, {}, false, false, 2});
  out.push_back({"csv, a scan a line",
                 "stamp_s,angle_min_rad,angle_increment_rad,ranges_m\n" +
                     lines(
                         12, 60, [&](int k) { return stamp(k) + ",-1.5,0.05"; }, ",", ""),
                 {},
                 false,
                 true});
  out.push_back({"--columns",
                 lines(
                     12, 60, [&](int k) { return stamp(k); }, " ", ""),
                 {.topic = "", .columns = "stamp,ranges"},
                 false,
                 true});
  std::string beams = "angle_deg,range_mm\n";
  for (int k = 0; k < 8; ++k) {
    const std::vector<float> ranges = ranges_of(k, 40);
    for (std::size_t i = 0; i < ranges.size(); ++i)
      beams += std::to_string(9 * i) + "," + std::to_string(std::lround(1000 * ranges[i])) + "\n";
  }
  out.push_back({"csv, a beam a line", beams, {}, true, true});
  return out;
}

TEST(Damage, TextLogsKeepWhatLiesBeforeIt) {
  const TempFolder dir;
  for (const TextFile& file : text_files()) {
    Sample plain = text_sample(file.name, file.text, dir / "log", file.options, file.beams);
    plain.open_end = file.open_end;
    expect_scans_once_told(plain, file.told_by);
    // A number cut short is one still, and so is a turn with fewer beams.
    if (file.open_end) {
      // Of a file that is one line nothing tells how long it was.
      const std::size_t lone = file.options.columns.empty() ? 0 : file.text.find('\n');
      plain.looks_whole = [text = file.text, beams = file.beams, lone](std::size_t cut) {
        return beams || cut < lone || cut == 0 || text.find_first_of(", ", cut) > text.find('\n', cut - 1);
      };
    }
    damage_everywhere(plain, kPlaces, dir / "log", dir / "log");
    Sample packed = text_sample(file.name + ", packed", pack_gzip(file.text), dir / "log", file.options, file.beams);
    packed.open_end = file.beams;
    expect_scans_once_told(packed, file.told_by);
    damage_everywhere(packed, kPlaces, dir / "log", dir / "log");
  }
}

std::vector<Message> messages(bool ros1) {
  const std::string slash = ros1 ? "/" : "/msg/";
  std::vector<Message> out;
  out.push_back({"/tf_static", "tf2_msgs" + slash + "TFMessage", kStart,
                 transforms(ros1, {{kStart, "base_link", "laser", 0.2, 0.1, {}}})});
  for (int k = 0; k < 12; ++k) {
    const std::int64_t t = kStart + k * std::int64_t{100'000'000};
    out.push_back({"/odom", "nav_msgs" + slash + "Odometry", t, odometry(ros1, t, 0.1 * k, 0, 0.1)});
    out.push_back({"/scan", "sensor_msgs" + slash + "LaserScan", t, laser_scan(ros1, t, ranges_of(k, 91))});
  }
  return out;
}

/// What lies before a place is told by the borders of the chunks: `ends[i]` is the end of a chunk with `scans[i]`
/// scans.
Sample recording(const std::string& name, const std::string& bytes, const std::vector<std::size_t>& borders) {
  Sample sample;
  sample.name = name;
  sample.bytes = bytes;
  sample.borders = borders;
  sample.scans_before = [n = bytes.size()](std::size_t at) { return at == n ? std::size_t{12} : 0; };
  return sample;
}

TEST(Damage, RecordingsSayWhatIsLost) {
  const TempFolder dir;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    for (const bool indexed : {true, false}) {
      BagStyle style;
      style.compression = compression;
      style.indexed = indexed;
      std::vector<std::size_t> borders;
      const std::string bytes = rosbag1(messages(true), style, &borders);
      Sample sample = recording(std::string("bag ") + compression, bytes, borders);
      // Without an index nothing says how many chunks there should be.
      if (!indexed) {
        sample.looks_whole = [borders](std::size_t at) {
          return std::find(borders.begin(), borders.end(), at) != borders.end();
        };
      }
      damage_everywhere(sample, kPlaces, dir / "log", dir / "log");
    }
  }
  for (const char* compression : {"", "lz4", "zstd"}) {
    for (const bool chunked : {true, false}) {
      McapStyle style;
      style.compression = compression;
      style.chunked = chunked;
      std::vector<std::size_t> borders;
      const std::string bytes = mcap(messages(false), style, &borders);
      damage_everywhere(recording(std::string("mcap ") + compression, bytes, borders), kPlaces, dir / "log",
                        dir / "log");
    }
  }
  McapStyle flat;
  flat.chunked = false;
  const std::string packed = pack_zstd(mcap(messages(false), flat));
  damage_everywhere(recording("mcap in zstd", packed, {}), kPlaces, dir / "log", dir / "log");
}

TEST(Damage, DatabasesGiveTheRowsOnWholePages) {
  const TempFolder dir;
  const std::vector<Message> all = messages(false);
  for (const bool message_compression : {false, true}) {
    for (const int page : {512, 4096}) {
      rosbag2_sqlite(dir / "db", all, message_compression, page);
      const std::string bytes = read_bytes(dir / "db");
      std::vector<std::size_t> borders;
      for (std::size_t at = static_cast<std::size_t>(page); at < bytes.size(); at += static_cast<std::size_t>(page))
        borders.push_back(at);
      damage_everywhere(recording("sqlite", bytes, borders), kPlaces, dir / "log", dir / "log");
    }
  }
  // A scan of a long log whose tree has grown a level stays readable when the page that leads to it is lost.
  std::vector<Message> many;
  for (int k = 0; k < 600; ++k)
    many.push_back({"/scan", "sensor_msgs/msg/LaserScan", kStart + k, laser_scan(false, kStart + k, ranges_of(k, 91))});
  rosbag2_sqlite(dir / "db", many, false, 512);
  const std::string bytes = read_bytes(dir / "db");
  for (int tenth = 2; tenth < 10; ++tenth) {
    write_bytes(dir / "half", bytes.substr(0, bytes.size() * static_cast<std::size_t>(tenth) / 10));
    const Reading read = read_damaged(dir / "half");
    EXPECT_GT(read.scans.size(), 50U * static_cast<std::size_t>(tenth)) << tenth;
    EXPECT_EQ(read.exit_code(), 4);
  }
}

TEST(Damage, AFolderIsReadWithoutItsMetadata) {
  const TempFolder dir;
  const std::vector<Message> all = messages(false);
  std::filesystem::create_directory(dir / "bag");
  rosbag2_sqlite(dir / "bag/x_0.db3", {all.begin(), all.begin() + 13});
  rosbag2_sqlite(dir / "bag/x_1.db3", {all.begin() + 13, all.end()});
  Sample sample = recording("metadata.yaml",
                            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
                            "  relative_file_paths:\n    - x_0.db3\n    - x_1.db3\n  duration:\n    nanoseconds: 5\n"
                            "  message_count: 25\n",
                            {});
  sample.scans_before = [](std::size_t) { return std::size_t{12}; };  // none lie in this file
  const std::size_t named_until = sample.bytes.find("message_count");
  for (std::size_t cut = 0; cut < named_until; ++cut) {
    write_bytes(dir / "bag/metadata.yaml", sample.bytes.substr(0, cut));
    const Reading read = read_damaged(dir / "bag");
    ASSERT_EQ(read.scans.size(), 12U) << cut << read.refused;
  }
}

}  // namespace
}  // namespace phasescan::damage_test
