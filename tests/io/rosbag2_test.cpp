// rosbag2: folders with and without metadata, splits, packed files and messages, bare databases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "phasescan/io/error.hpp"
#include "support/recordings.hpp"
#include "support/temp.hpp"

namespace phasescan::rosbag2_test {
namespace {

using namespace test;

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

}  // namespace
}  // namespace phasescan::rosbag2_test
