// The recorded data, cut and with bits flipped. $PHASESCAN_DAMAGE_PLACES=200 takes as many places of each file as of
// the small generated ones (tests/io/damage_test.cpp); fewer suffice for every day.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "support/damage.hpp"
#include "support/data.hpp"

namespace phasescan {
namespace {

using namespace test;

std::size_t places(std::size_t bytes) {
  const char* stated = std::getenv("PHASESCAN_DAMAGE_PLACES");
  if (stated != nullptr) return static_cast<std::size_t>(std::atol(stated));
  return std::clamp<std::size_t>(30'000'000 / bytes, 10, 100);
}

void report(const Sample& sample, const DamageTally& tally) {
  std::printf("%-28s %4zu cuts %4zu flips: %4zu named, %4zu refused, %4zu exit 0 or 1 (%zu scans lost)\n",
              sample.name.c_str(), tally.cuts, tally.flips, tally.named, tally.refused, tally.unnamed, tally.silent);
}

/// The scans of a ROS recording: where each ends in the file, and where records begin.
struct Walk {
  std::vector<std::size_t> borders, scan_ends;
};

std::uint32_t u32_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}
std::uint64_t u64_at(const std::string& bytes, std::size_t at) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + at, 8);
  return value;
}

void walk_mcap(const std::string& bytes, std::size_t at, std::size_t end, std::string& scan_channel, Walk& out) {
  while (at + 9 <= end) {
    out.borders.push_back(at);
    const int op = bytes[at];
    const std::size_t body = at + 9, next = body + u64_at(bytes, at + 1);
    if (op == 6) {
      const std::size_t name = u32_at(bytes, body + 28);
      if (name == 0) walk_mcap(bytes, body + 32 + 8, next, scan_channel, out);
    } else if (op == 4 && bytes.substr(body, next - body).find("/scan") != std::string::npos) {
      scan_channel = bytes.substr(body, 2);
    } else if (op == 5 && bytes.substr(body, 2) == scan_channel) {
      out.scan_ends.push_back(next);
    } else if (op == 15) {
      return;
    }
    at = next;
  }
}

void walk_bag(const std::string& bytes, std::size_t at, std::size_t end, std::string& scan_connection, Walk& out) {
  while (at + 8 <= end) {
    out.borders.push_back(at);
    const std::size_t header = at + 4, header_end = header + u32_at(bytes, at);
    const std::string fields = bytes.substr(header, header_end - header);
    const auto value = [&](const std::string& name) {
      return fields.substr(fields.find(name + "=") + name.size() + 1);
    };
    const int op = value("op")[0];
    std::size_t data = u32_at(bytes, header_end);
    const std::size_t body = header_end + 4;
    if (op == 4) data = 12 * std::size_t{u32_at(value("count"), 0)};
    if (op == 5 && value("compression").starts_with("none")) {
      walk_bag(bytes, body, body + data, scan_connection, out);
    } else if (op == 5) {
      std::string chunk(u32_at(value("size"), 0), '\0');
      auto size = static_cast<unsigned>(chunk.size());
      BZ2_bzBuffToBuffDecompress(chunk.data(), &size, const_cast<char*>(bytes.data() + body),
                                 static_cast<unsigned>(data), 0, 0);
      Walk inside;
      walk_bag(chunk, 0, chunk.size(), scan_connection, inside);
      out.scan_ends.insert(out.scan_ends.end(), inside.scan_ends.size(), body + data);
    }
    if (op == 7 && bytes.substr(body, data).find("sensor_msgs/LaserScan") != std::string::npos)
      scan_connection = value("conn").substr(0, 4);
    if (op == 2 && value("conn").substr(0, 4) == scan_connection) out.scan_ends.push_back(body + data);
    at = body + data;
  }
}

Sample recording(const std::string& name, const Walk& walk, std::string bytes) {
  Sample sample;
  sample.name = name;
  sample.borders = walk.borders;
  sample.scans_before = [walk](std::size_t n) {
    return static_cast<std::size_t>(std::upper_bound(walk.scan_ends.begin(), walk.scan_ends.end(), n) -
                                    walk.scan_ends.begin());
  };
  sample.bytes = std::move(bytes);
  return sample;
}

TEST(SharedDamage, TextLogs) {
  const std::string root = recorded_data("carmen");
  if (root.empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const TempFolder dir;
  for (const char* file :
       {"carmen/intel-corrected.log.gz", "carmen/intel-raw.log.gz", "carmen/freiburg-079-corrected.log.gz",
        "carmen/fr079-raw.log.gz", "lowcost/rplidar-a1-16m.log.gz", "lowcost/rplidar-a1-14m.log.gz",
        "lowcost/breezy-exp1.dat.gz", "lowcost/ydlidar-x4-a.dat.gz", "lowcost/ydlidar-x4-c.dat.gz"}) {
    const Sample sample = text_sample(file, read_bytes(recorded_data(file)), dir / "log");
    report(sample, damage_everywhere(sample, places(5 * sample.bytes.size()), dir / "log", dir / "log"));
  }
}

TEST(SharedDamage, Recordings) {
  if (recorded_data("bags").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const TempFolder dir;
  for (const char* file : {"hokuyo-2010-original.bag", "hokuyo-demo.bag", "hokuyo-demo-bz2.bag", "hokuyo-demo.mcap",
                           "breezy-exp1.bag", "breezy-exp1-bz2.bag", "breezy-exp1.mcap"}) {
    std::string bytes = read_bytes(recorded_data(std::string("bags/") + file));
    Walk walk;
    std::string channel = "none";
    if (bytes.starts_with("#ROSBAG")) {
      walk_bag(bytes, 13, bytes.size(), channel, walk);
    } else {
      walk_mcap(bytes, 8, bytes.size(), channel, walk);
    }
    const Sample sample = recording(file, walk, std::move(bytes));
    report(sample, damage_everywhere(sample, places(sample.bytes.size()), dir / "log", dir / "log"));
  }
}

TEST(SharedDamage, Folders) {
  if (recorded_data("bags").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const auto& [name, scans] :
       std::vector<std::pair<std::string, std::size_t>>{{"hokuyo-demo", 360}, {"breezy-exp1", 756}}) {
    const TempFolder dir;
    const std::string from = recorded_data("bags/" + name);
    const std::vector<std::string> files{"/metadata.yaml", "/" + name + "_0.db3"};
    for (const std::string& file : files) write_bytes(dir.path() + file, read_bytes(from + file));
    for (const std::string& file : files) {
      Sample sample;
      sample.name = name + file;
      sample.bytes = read_bytes(from + file);
      // A database's tables lie scattered over its pages: what can be read of half a file only the file can tell.
      sample.scans_before = [n = sample.bytes.size(), scans](std::size_t at) { return at == n ? scans : 0; };
      report(sample, damage_everywhere(sample, places(sample.bytes.size()), dir.path() + file, dir.path()));
      write_bytes(dir.path() + file, sample.bytes);
    }
  }
}

}  // namespace
}  // namespace phasescan
