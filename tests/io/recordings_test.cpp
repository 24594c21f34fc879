// rosbag1, rosbag2 and MCAP: the same messages in every container are the same scans, whatever else is in the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "phasescan/io/log.hpp"
#include "phasescan/io/error.hpp"
#include "support/ros_fixture.hpp"
#include "support/temp.hpp"

namespace phasescan {
namespace {

using namespace test;
constexpr std::int64_t kStart = 1'600'000'000'000'000'000;
constexpr std::int64_t kMs = 1'000'000;
const std::string kScanType = "sensor_msgs/LaserScan";

std::vector<float> ranges_of(int k) {
  std::vector<float> out(91);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = 1.0F + 0.01F * static_cast<float>((static_cast<std::size_t>(k) * 7 + i * 3) % 200);
  out[3] = 0.0F;
  out[4] = std::numeric_limits<float>::infinity();
  out[5] = std::numeric_limits<float>::quiet_NaN();
  out[6] = 0.01F;
  return out;
}

/// Scans every 100 ms between odometry samples every 50 ms at x = t, and a static transform.
std::vector<Message> messages(bool ros1, int scans = 11) {
  const std::string slash = ros1 ? "/" : "/msg/";
  std::vector<Message> out;
  out.push_back({"/tf_static", "tf2_msgs" + slash + "TFMessage", kStart,
                 transforms(ros1, {{kStart, "base_link", "plate", 0.1, 0.0, {}},
                                   {kStart, "plate", "laser", 0.1, 0.05, {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}})});
  out.push_back({"/chatter", "std_msgs" + slash + "String", kStart, "\1\2\3"});
  for (int k = 0; k < scans; ++k) {
    const std::int64_t t = kStart + k * 100 * kMs;
    out.push_back(
        {"/odom", "nav_msgs" + slash + "Odometry", t, odometry(ros1, t - 25 * kMs, 0.1 * k - 0.025, 2.0, 0.1 * k)});
    out.push_back({"/scan", "sensor_msgs" + slash + "LaserScan", t, laser_scan(ros1, t, ranges_of(k))});
    out.push_back({"/odom", "nav_msgs" + slash + "Odometry", t + 30 * kMs,
                   odometry(ros1, t + 25 * kMs, 0.1 * k + 0.025, 2.0, 0.1 * k)});
  }
  return out;
}

struct Read {
  std::vector<LogEntry> entries;
  std::vector<LogDamage> damages;
  std::string format;
  std::map<std::string, std::string> facts;
};

Read read_all(const std::string& path, const LogOptions& options = {}) {
  const auto log = open_log(path, options);
  Read out;
  while (auto entry = log->next()) out.entries.push_back(std::move(*entry));
  out.damages = log->damages();
  out.format = log->format();
  out.facts = log->facts();
  return out;
}

void expect_whole(const Read& read, int scans = 11) {
  EXPECT_TRUE(read.damages.empty()) << read.damages.front().text;
  ASSERT_EQ(read.entries.size(), static_cast<std::size_t>(scans));
  for (int k = 0; k < scans; ++k) {
    const LogEntry& entry = read.entries[static_cast<std::size_t>(k)];
    EXPECT_EQ(entry.scan.stamp, kStart + k * 100 * kMs);
    EXPECT_EQ(entry.laser, "/scan");
    const std::vector<float> expected = ranges_of(k);
    ASSERT_EQ(entry.scan.size(), expected.size());
    for (std::size_t i = 7; i < expected.size(); ++i) ASSERT_EQ(entry.scan.ranges[i], expected[i]);
    EXPECT_EQ(entry.scan.states[3], BeamState::kNoReturn);
    EXPECT_EQ(entry.scan.states[4], BeamState::kOutOfRange);
    EXPECT_EQ(entry.scan.states[5], BeamState::kInvalid);
    EXPECT_EQ(entry.scan.states[6], BeamState::kTooNear);
    ASSERT_TRUE(entry.odometry);
    EXPECT_NEAR(entry.odometry->x, 0.1 * k, 1e-12);
    EXPECT_NEAR(entry.odometry->y, 2.0, 1e-12);
    EXPECT_NEAR(entry.odometry->theta, 0.1 * k, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.x, 0.2, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.y, 0.05, 1e-12);
    EXPECT_NEAR(entry.T_base_laser.theta, M_PI / 2, 1e-9);
    EXPECT_FALSE(entry.flipped);
  }
}

TEST(Rosbag1, ReadsEveryCompressionWithAndWithoutIndex) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    for (const bool indexed : {true, false}) {
      SCOPED_TRACE(std::string(compression) + (indexed ? " indexed" : ""));
      const TempFolder dir;
      BagStyle style;
      style.compression = compression;
      style.indexed = indexed;
      write_bytes(dir / "a", rosbag1(messages(true), style));
      const Read read = read_all(dir / "a");
      expect_whole(read);
      EXPECT_EQ(read.format, "rosbag1");
      EXPECT_EQ(read.facts.at("odometry from"), "/odom");
    }
  }
}

TEST(Rosbag1, WalksOverIndexRecordsThatStateTwentyBytesForTwelve) {
  const TempFolder dir;
  BagStyle style;
  style.index_of_2010 = true;
  write_bytes(dir / "a", rosbag1(messages(true), style));
  expect_whole(read_all(dir / "a"));
}

TEST(Rosbag1, RefusesOlderFormatsByName) {
  const TempFolder dir;
  write_bytes(dir / "a", "#ROSRECORD V1.2\n" + std::string(100, 'x'));
  try {
    read_all(dir / "a");
    FAIL() << "an old bag was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ROSRECORD V1.2"));
    EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
  }
}

TEST(Rosbag1, GoesOnBehindADamagedChunk) {
  const TempFolder dir;
  BagStyle style;
  style.compression = "bz2";
  style.messages_a_chunk = 6;
  std::vector<std::size_t> borders;
  std::string bag = rosbag1(messages(true), style, &borders);
  bag[borders[1] + 150] = static_cast<char>(bag[borders[1] + 150] ^ 0x55);
  write_bytes(dir / "a", bag);
  const Read read = read_all(dir / "a");
  EXPECT_EQ(read.damages.at(0).kind, "bad chunk");
  EXPECT_GE(read.entries.size(), 8U);
  EXPECT_LT(read.entries.size(), 11U);
}

TEST(Mcap, ReadsChunkedOrNotWithAndWithoutSummary) {
  for (const char* compression : {"", "lz4", "zstd"}) {
    for (const bool chunked : {true, false}) {
      const TempFolder dir;
      McapStyle style;
      style.compression = compression;
      style.chunked = chunked;
      write_bytes(dir / "a", mcap(messages(false), style));
      expect_whole(read_all(dir / "a"));
    }
  }
}

TEST(Mcap, ReadsRos1MessagesAndPackedMessages) {
  const TempFolder dir;
  McapStyle ros1;
  ros1.encoding = "ros1";
  write_bytes(dir / "ros1", mcap(messages(true), ros1));
  expect_whole(read_all(dir / "ros1"));
  McapStyle packed;
  packed.message_compression = true;
  write_bytes(dir / "packed", mcap(messages(false), packed));
  expect_whole(read_all(dir / "packed"));
}

TEST(Mcap, NamesAChecksumThatDoesNotFitAndAMissingEnd) {
  const TempFolder dir;
  McapStyle style;
  style.crc = 0x12345678;
  style.messages_a_chunk = 1000;
  write_bytes(dir / "crc", mcap(messages(false), style));
  const Read wrong = read_all(dir / "crc");
  EXPECT_EQ(wrong.entries.size(), 11U);
  ASSERT_EQ(wrong.damages.size(), 1U);
  EXPECT_THAT(wrong.damages[0].text, testing::HasSubstr("checksum"));
  McapStyle open;
  open.end_records = false;
  write_bytes(dir / "open", mcap(messages(false), open));
  const Read cut = read_all(dir / "open");
  EXPECT_EQ(cut.entries.size(), 11U);
  EXPECT_EQ(cut.damages.size(), 1U);
}

TEST(Rosbag2, ReadsABareFileAFolderSplitsAndCompression) {
  const TempFolder dir;
  const auto all = messages(false);
  rosbag2_sqlite(dir / "bare.db3", all);
  expect_whole(read_all(dir / "bare.db3"));
  rosbag2_sqlite(dir / "packed.db3", all, true);
  expect_whole(read_all(dir / "packed.db3"));

  const std::vector<Message> first(all.begin(), all.begin() + 15);
  const std::vector<Message> second(all.begin() + 15, all.end());
  const auto folder = [&](const std::string& name, const std::string& yaml_files, const std::string& more) {
    std::filesystem::create_directory(dir / name);
    write_bytes(dir / (name + "/metadata.yaml"),
                "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n" +
                    yaml_files + more);
    return dir / name;
  };
  const std::string splits = folder("splits", "    - x_0.db3\n    - x_1.db3\n", "");
  rosbag2_sqlite(splits + "/x_0.db3", first);
  rosbag2_sqlite(splits + "/x_1.db3", second);
  expect_whole(read_all(splits));

  // Old recordings name their own folder in front; compressed ones may leave the .zstd out.
  const std::string old =
      folder("old", "    - old/x_0.db3\n    - old/x_1.db3\n", "  compression_format: zstd\n  compression_mode: FILE\n");
  write_bytes(old + "/x_0.db3.zstd", pack_zstd(read_bytes(splits + "/x_0.db3")));
  write_bytes(old + "/x_1.db3", read_bytes(splits + "/x_1.db3"));
  expect_whole(read_all(old));

  const std::string mixed = folder("mcap", "    - x_0.mcap\n    - x_1.mcap.zstd\n", "");
  write_bytes(mixed + "/x_0.mcap", mcap(first));
  write_bytes(mixed + "/x_1.mcap.zstd", pack_zstd(mcap(second)));
  const Read read = read_all(mixed);
  expect_whole(read);
  EXPECT_EQ(read.facts.at("files"), "2");

  // Without metadata the files are taken by their numbers: 2 before 10.
  std::filesystem::create_directory(dir / "bare");
  write_bytes(dir / "bare/x_2.mcap", mcap(first));
  write_bytes(dir / "bare/x_10.mcap", mcap(second));
  expect_whole(read_all(dir / "bare"));
}

TEST(Rosbag2, NamesAMissingSplitAndReadsTheOthers) {
  const TempFolder dir;
  std::filesystem::create_directory(dir / "bag");
  write_bytes(dir / "bag/metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [x_0.db3, x_1.db3]\n");
  rosbag2_sqlite(dir / "bag/x_1.db3", messages(false));
  const Read read = read_all(dir / "bag");
  EXPECT_EQ(read.entries.size(), 11U);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_EQ(read.damages[0].kind, "missing file");
  EXPECT_THAT(read.damages[0].text, testing::HasSubstr("x_0.db3"));
}

TEST(Rosbag2, RefusesWhatIsNoRecording) {
  const TempFolder dir;
  std::filesystem::create_directory(dir / "empty");
  EXPECT_THROW(read_all(dir / "empty"), InputError);
  std::filesystem::create_directory(dir / "bad");
  write_bytes(dir / "bad/metadata.yaml", "a: [1,\n");
  EXPECT_THROW(read_all(dir / "bad"), InputError);
  sqlite3* db = nullptr;
  sqlite3_open((dir / "view.db3").c_str(), &db);
  run_sql(db,
          "CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT);"
          "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
          "SELECT id, 1 AS topic_id, 1 AS timestamp, 'x' AS data FROM n");
  sqlite3_close(db);
  EXPECT_THROW(read_all(dir / "view.db3"), InputError);
}

TEST(RosLog, ATopicIsChosenOrNamedAsMissing) {
  const TempFolder dir;
  auto all = messages(false, 3);
  all.push_back({"/rear", "sensor_msgs/msg/LaserScan", kStart, laser_scan(false, kStart, ranges_of(9))});
  write_bytes(dir / "a", mcap(all));
  EXPECT_EQ(read_all(dir / "a").entries.size(), 4U);
  const Read rear = read_all(dir / "a", {.topic = "/rear", .columns = ""});
  ASSERT_EQ(rear.entries.size(), 1U);
  EXPECT_EQ(rear.entries[0].laser, "/rear");
  try {
    read_all(dir / "a", {.topic = "/front", .columns = ""});
    FAIL() << "a topic that is not there was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/rear, /scan"));
  }
}

TEST(RosLog, ALaserUpsideDownIsFlippedAndOdometryComesFromTheTransform) {
  const TempFolder dir;
  std::vector<Message> all;
  all.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
                 transforms(false, {{kStart, "base_footprint", "laser", 0.3, 0.1, {1, 0, 0, 0}}})});
  for (int k = 0; k < 5; ++k) {
    const std::int64_t t = kStart + k * 100 * kMs;
    all.push_back({"/tf", "tf2_msgs/msg/TFMessage", t,
                   transforms(false, {{t, "odom", "base_footprint", 0.5 * k, 0, {}}, {t, "map", "odom", 100, 0, {}}})});
    all.push_back({"/scan", "sensor_msgs/msg/LaserScan", t, laser_scan(false, t, ranges_of(k))});
  }
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_TRUE(read.entries[k].flipped);
    EXPECT_NEAR(read.entries[k].T_base_laser.x, 0.3, 1e-12);
    EXPECT_NEAR(read.entries[k].T_base_laser.theta, 0.0, 1e-12);
    ASSERT_TRUE(read.entries[k].odometry);
    EXPECT_NEAR(read.entries[k].odometry->x, 0.5 * static_cast<double>(k), 1e-12);
  }
}

TEST(RosLog, ScansFarFromAnyOdometryHaveNone) {
  const TempFolder dir;
  std::vector<Message> all;
  for (int k = 0; k < 20; ++k) {
    const std::int64_t t = kStart + k * 500 * kMs;
    if (k < 3) all.push_back({"/odom", "nav_msgs/msg/Odometry", t, odometry(false, t, 1.0 * k, 0, 0)});
    all.push_back({"/scan", "sensor_msgs/msg/LaserScan", t, laser_scan(false, t, ranges_of(k))});
  }
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 20U);
  EXPECT_TRUE(read.entries[2].odometry);
  EXPECT_FALSE(read.entries[3].odometry);
  EXPECT_FALSE(read.entries[19].odometry);
}

TEST(RosLog, NonsenseInAScanIsReadAsUnknown) {
  const TempFolder dir;
  std::vector<Message> all;
  all.push_back(
      {"/scan", "sensor_msgs/msg/LaserScan", kStart, laser_scan(false, kStart, ranges_of(1), "laser", 0.0F, 5.0F)});
  all.push_back({"/scan", "sensor_msgs/msg/LaserScan", kStart, "no scan at all"});
  write_bytes(dir / "a", mcap(all));
  const Read read = read_all(dir / "a");
  ASSERT_EQ(read.entries.size(), 1U);
  EXPECT_EQ(read.entries[0].scan.geometry.range_max, 0.0);
  EXPECT_EQ(read.entries[0].scan.time_increment, 0.0);
  ASSERT_EQ(read.damages.size(), 1U);
  EXPECT_EQ(read.damages[0].kind, "bad message");
  EXPECT_THAT(read.damages[0].text, testing::HasSubstr("message 2 of /scan"));
}

/// Reads whatever is left of a file: no crash, no hang, and damage is named where scans are lost.
void expect_survives(const std::string& path, std::size_t whole, bool cut) {
  try {
    const Read read = read_all(path);
    EXPECT_LE(read.entries.size(), whole);
    if (cut && read.entries.size() < whole) {
      EXPECT_FALSE(read.damages.empty()) << read.entries.size() << " scans and no word about the others";
    }
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(path));
  }
}

TEST(Damage, AnyCutAndAnyFlippedBitIsSurvived) {
  const TempFolder dir;
  struct Sample {
    std::string name;
    std::string bytes;
    std::vector<std::size_t> borders;
  };
  std::vector<Sample> samples;
  for (const char* compression : {"none", "bz2", "lz4"}) {
    BagStyle style;
    style.compression = compression;
    Sample sample{std::string("bag ") + compression, "", {}};
    sample.bytes = rosbag1(messages(true), style, &sample.borders);
    samples.push_back(sample);
  }
  for (const char* compression : {"", "lz4", "zstd"}) {
    McapStyle style;
    style.compression = compression;
    Sample sample{std::string("mcap ") + compression, "", {}};
    sample.bytes = mcap(messages(false), style, &sample.borders);
    samples.push_back(sample);
  }
  rosbag2_sqlite(dir / "db", messages(false), false, 512);
  samples.push_back({"sqlite", read_bytes(dir / "db"), {}});
  for (const Sample& sample : samples) {
    SCOPED_TRACE(sample.name);
    std::vector<std::size_t> cuts;
    for (std::size_t i = 0; i < 200; ++i) cuts.push_back(sample.bytes.size() * i / 200);
    for (const std::size_t border : sample.borders) {
      for (const std::size_t cut : {border - 1, border, border + 1}) cuts.push_back(cut);
    }
    for (const std::size_t cut : cuts) {
      write_bytes(dir / "cut", sample.bytes.substr(0, cut));
      expect_survives(dir / "cut", 11, true);
      std::string flipped = sample.bytes;
      flipped[cut % flipped.size()] = static_cast<char>(flipped[cut % flipped.size()] ^ (1 << (cut % 8)));
      write_bytes(dir / "flip", flipped);
      expect_survives(dir / "flip", 11, false);
    }
  }
}

TEST(Damage, WhatLiesBeforeACutIsDelivered) {
  const TempFolder dir;
  BagStyle style;
  std::vector<std::size_t> borders;
  const std::string bag = rosbag1(messages(true), style, &borders);
  write_bytes(dir / "bag", bag.substr(0, bag.size() / 2));
  const Read half_bag = read_all(dir / "bag");
  EXPECT_GE(half_bag.entries.size(), 4U);
  EXPECT_EQ(half_bag.damages.size(), 1U);
  const std::string file = mcap(messages(false));
  write_bytes(dir / "mcap", file.substr(0, file.size() / 2));
  const Read half_mcap = read_all(dir / "mcap");
  EXPECT_GE(half_mcap.entries.size(), 4U);
  EXPECT_EQ(half_mcap.damages.size(), 1U);
  rosbag2_sqlite(dir / "db", messages(false, 40));
  const std::string db = read_bytes(dir / "db");
  write_bytes(dir / "half", db.substr(0, db.size() / 2));
  const Read half_db = read_all(dir / "half");
  EXPECT_GE(half_db.entries.size(), 10U);
  EXPECT_GE(half_db.damages.size(), 1U);
}

}  // namespace
}  // namespace phasescan
