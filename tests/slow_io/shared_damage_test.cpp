// The recorded data, cut and with bits flipped. $PHASESCAN_DAMAGE_PLACES=200 takes as many places of each file as of
// the small generated ones (tests/io/damage_test.cpp); fewer suffice for every day.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "support/damage.hpp"
#include "support/data.hpp"
#include "support/unwrap.hpp"

namespace phasescan::shared_damage_test {
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

TEST(SharedDamage, TextLogs) {
  const std::string root = recorded_data("carmen");
  if (root.empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const TempFolder dir;
  for (const char* file :
       {"carmen/intel-corrected.log.gz", "carmen/intel-raw.log.gz", "carmen/freiburg-079-corrected.log.gz",
        "carmen/fr079-raw.log.gz", "lowcost/rplidar-a1-16m.log.gz", "lowcost/rplidar-a1-14m.log.gz",
        "lowcost/breezy-exp1.dat.gz", "lowcost/ydlidar-x4-a.dat.gz", "lowcost/ydlidar-x4-c.dat.gz"}) {
    Sample sample = text_sample(file, read_bytes(recorded_data(file)), dir / "log");
    // Told from a matrix by the number of its beams, which changes from scan to scan.
    if (sample.name.starts_with("lowcost/ydlidar")) sample.recognised_from = 2;
    report(sample, damage_everywhere(sample, places(5 * sample.bytes.size()), dir / "log", dir / "log"));
  }
}

TEST(SharedDamage, Recordings) {
  if (recorded_data("bags").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const TempFolder dir;
  for (const char* file : {"hokuyo-2010-original.bag", "hokuyo-demo.bag", "hokuyo-demo-bz2.bag", "hokuyo-demo.mcap",
                           "breezy-exp1.bag", "breezy-exp1-bz2.bag", "breezy-exp1.mcap"}) {
    Sample sample;
    sample.name = file;
    sample.bytes = read_bytes(recorded_data(sample.name.insert(0, "bags/")));
    const bool bag = sample.bytes.starts_with("#ROSBAG");
    const Unwrapped content = bag ? BagUnwrapper::unwrap(sample.bytes) : McapUnwrapper::unwrap(sample.bytes);
    sample.borders = content.borders;
    sample.scans_before = [&content](std::size_t n) { return content.scans_before(n); };
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
      sample.scans_before = [n = sample.bytes.size(), count = scans](std::size_t at) { return at == n ? count : 0; };
      report(sample, damage_everywhere(sample, places(sample.bytes.size()), dir.path() + file, dir.path()));
      write_bytes(dir.path() + file, sample.bytes);
    }
  }
}

}  // namespace
}  // namespace phasescan::shared_damage_test
