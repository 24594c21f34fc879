// `slam` on the recorded data: the same scans in any container give the same trajectory to the last byte, and every
// other log is walked to its end.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "support/command.hpp"
#include "support/damage.hpp"
#include "support/data.hpp"
#include "support/unwrap.hpp"

namespace phasescan::containers_test {
namespace {

using namespace test;

/// The trajectory that `slam` writes of a log.
std::string trajectory_of(const std::string& log, const std::vector<std::string>& more = {}) {
  const TempFolder out;
  std::vector<std::string> words{"slam", log, "--out", out / "out", "--no-times"};
  words.insert(words.end(), more.begin(), more.end());
  const CommandResult result = run_command(words);
  EXPECT_TRUE(result.code == 0 || result.code == 1) << log << ": " << result.err;  // 1: its verdict is "failed"
  return slurp(out / "out/trajectory.tum");
}

/// Containers that are not among the recorded files, made of a recording's own messages.
std::vector<std::string> make_others(const std::string& bags, const std::string& name, const TempFolder& dir) {
  const std::vector<Message> cdr = McapUnwrapper::unwrap(read_bytes(bags + name + ".mcap")).messages;
  const std::vector<Message> ros1 = BagUnwrapper::unwrap(read_bytes(bags + name + ".bag")).messages;
  EXPECT_EQ(cdr.size(), ros1.size());
  std::vector<std::string> out;
  const auto put = [&](const std::string& file, const std::string& bytes) {
    write_bytes(dir / file, bytes);
    out.push_back(dir / file);
  };
  BagStyle lz4_bag;
  lz4_bag.compression = "lz4";
  put("lz4.bag", rosbag1(ros1, lz4_bag));
  BagStyle unindexed;
  unindexed.indexed = false;
  put("unindexed.bag", rosbag1(ros1, unindexed));
  for (const char* compression : {"lz4", "zstd"}) {
    McapStyle style;
    style.compression = compression;
    put(std::string(compression) + ".mcap", mcap(cdr, style));
  }
  McapStyle flat;
  flat.chunked = false;
  put("flat.mcap", mcap(cdr, flat));
  put("packed.mcap.zst", pack_zstd(read_bytes(bags + name + ".mcap")));
  put("packed.bag.gz", pack_gzip(read_bytes(bags + name + ".bag")));
  rosbag2_sqlite(dir / "messages.db3", cdr, true);
  out.push_back(dir / "messages.db3");
  std::filesystem::create_directory(dir / "splits");
  const auto half = cdr.begin() + static_cast<std::ptrdiff_t>(cdr.size() / 2);
  rosbag2_sqlite(dir / "first.db3", {cdr.begin(), half});
  write_bytes(dir / "splits/x_0.db3.zstd", pack_zstd(read_bytes(dir / "first.db3")));
  rosbag2_sqlite(dir / "splits/x_1.db3", {half, cdr.end()});
  out.push_back(dir / "splits");
  return out;
}

TEST(Containers, OfTheSameScansGiveTheSameTrajectory) {
  const std::string bags = recorded_data("bags") + "/";
  if (bags == "/") GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const auto& [name, more] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"hokuyo-demo", {"hokuyo-2010-original.bag"}}, {"breezy-exp1", {}}}) {
    const TempFolder dir;
    std::vector<std::string> logs{bags + name + ".bag", bags + name + "-bz2.bag", bags + name + ".mcap", bags + name,
                                  bags + name + "/" + name + "_0.db3"};
    for (const std::string& file : more) logs.push_back(bags + file);
    const std::vector<std::uint64_t> scans = read_damaged(logs.front()).scans;
    const std::string trajectory = trajectory_of(logs.front());
    ASSERT_EQ(line_ends(trajectory).size(), scans.size());
    for (const std::string& log : logs) {
      EXPECT_EQ(read_damaged(log).scans, scans) << log;
      EXPECT_EQ(trajectory_of(log), trajectory) << log;
    }
    const std::vector<std::string> others = make_others(bags, name, dir);
    for (const std::string& log : others) {
      const Reading read = read_damaged(log);
      EXPECT_EQ(read.scans, scans) << log << read.refused;
      EXPECT_EQ(read.exit_code(), 0) << log;
    }
    // One of each compression through the command, too; the scans say the rest.
    for (const std::size_t i : {0U, 3U, 7U}) EXPECT_EQ(trajectory_of(others[i]), trajectory) << others[i];
    // A scan log holds all that slam looks at.
    ASSERT_EQ(run_command({"convert", logs.front(), dir / "log.jsonl.gz"}).code, 0);
    EXPECT_EQ(trajectory_of(dir / "log.jsonl.gz"), trajectory);
    std::printf("%s: %zu containers and a scan log, %zu scans, one trajectory\n", name.c_str(),
                logs.size() + others.size(), scans.size());
  }
}

TEST(Containers, EveryTextLogIsWalkedToItsEnd) {
  const std::string lowcost = recorded_data("lowcost") + "/";
  if (lowcost == "/") GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const auto& [file, scans] :
       std::vector<std::pair<std::string, std::size_t>>{{"lowcost/rplidar-a1-14m.log.gz", 237},
                                                        {"lowcost/breezy-exp1.dat.gz", 756},
                                                        {"lowcost/ydlidar-x4-a.dat.gz", 213},
                                                        {"lowcost/ydlidar-x4-c.dat.gz", 520},
                                                        {"carmen/intel-corrected.log.gz", 910}}) {
    EXPECT_EQ(line_ends(trajectory_of(recorded_data(file))).size(), scans) << file;
  }
  // A CSV of the same ranges as a tool would write it.
  const TempFolder dir;
  std::string csv = "stamp_s,angle_min_deg,angle_increment_deg,ranges_mm\n";
  const auto log = open_log(recorded_data("lowcost/rplidar-a1-14m.log.gz"));
  while (const auto entry = log->next()) {
    csv += std::to_string(static_cast<double>(entry->scan.stamp) * 1e-9) + ",0,-1";
    for (const float range : entry->scan.ranges)
      csv += "," + (std::isnan(range) ? std::string("0") : std::to_string(std::lround(range * 1000.0F)));
    csv += "\n";
  }
  EXPECT_EQ(line_ends(trajectory_of(dir.put("log.csv", csv))).size(), 237U);
}

}  // namespace
}  // namespace phasescan::containers_test
