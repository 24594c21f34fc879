// Real recordings, where they are at hand: one set of scans in four containers is the same to the last bit.
#include <gtest/gtest.h>

#include <cmath>

#include "phasescan/io/error.hpp"
#include "phasescan/io/log.hpp"
#include "support/data.hpp"

namespace phasescan::shared_recordings_test {
namespace {

struct Content {
  std::size_t scans = 0, odometry = 0, damages = 0;
  std::string bytes;  ///< all that a scan says
  bool operator==(const Content&) const = default;
};

template <class T>
void append(std::string& out, const T* values, std::size_t n) {
  out.append(reinterpret_cast<const char*>(values), n * sizeof(T));
}

Content read_content(const std::string& path) {
  Content out;
  const auto log = open_log(path);
  while (const auto entry = log->next()) {
    ++out.scans;
    const Scan& scan = entry->scan;
    append(out.bytes, &scan.stamp, 1);
    append(out.bytes, &scan.geometry, 1);
    append(out.bytes, &scan.time_increment, 1);
    append(out.bytes, scan.states.data(), scan.size());
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const float raw = raw_range(scan, i);
      if (!std::isnan(raw)) append(out.bytes, &raw, 1);
    }
    append(out.bytes, scan.intensities.data(), scan.intensities.size());
    if (!entry->odometry) continue;
    ++out.odometry;
    append(out.bytes, &*entry->odometry, 1);
  }
  out.damages = log->damage_count();
  return out;
}

TEST(SharedRecordings, AreTheSameScansInEveryContainer) {
  const std::string bags = test::recorded_data("bags") + "/";
  if (bags == "/") GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  struct Set {
    std::size_t scans, odometry;
    std::vector<const char*> files;
  };
  for (const Set& set : {Set{360,
                             0,
                             {"hokuyo-2010-original.bag", "hokuyo-demo.bag", "hokuyo-demo-bz2.bag", "hokuyo-demo.mcap",
                              "hokuyo-demo", "hokuyo-demo/hokuyo-demo_0.db3"}},
                         Set{756,
                             756,
                             {"breezy-exp1.bag", "breezy-exp1-bz2.bag", "breezy-exp1.mcap", "breezy-exp1",
                              "breezy-exp1/breezy-exp1_0.db3"}}}) {
    const Content first = read_content(bags + set.files[0]);
    EXPECT_EQ(first.scans, set.scans);
    EXPECT_EQ(first.odometry, set.odometry);
    EXPECT_EQ(first.damages, 0U);
    for (const char* file : set.files) EXPECT_TRUE(read_content(bags + file) == first) << file;
  }
}

TEST(SharedRecordings, TheWheelOdometryOfTheTextIsThatOfItsBag) {
  if (test::recorded_data("bags").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const auto text = open_log(test::recorded_data("lowcost/breezy-exp1.dat.gz"));
  const auto bag = open_log(test::recorded_data("bags/breezy-exp1.mcap"));
  std::size_t count = 0;
  while (const auto from_text = text->next()) {
    const auto from_bag = bag->next();
    ASSERT_TRUE(from_bag);
    ++count;
    ASSERT_EQ(from_text->scan.size(), from_bag->scan.size());
    for (std::size_t i = 0; i < from_text->scan.size(); ++i) {
      ASSERT_EQ(from_text->scan.is_hit(i), from_bag->scan.is_hit(i)) << count << " " << i;
      ASSERT_NEAR(from_text->scan.angle(i), from_bag->scan.angle(i), 2e-5);
      if (!from_text->scan.is_hit(i)) continue;
      ASSERT_FLOAT_EQ(from_text->scan.ranges[i], from_bag->scan.ranges[i]);
    }
    ASSERT_LT(translation_distance(*from_text->odometry, *from_bag->odometry), 0.05) << count;
    ASSERT_LT(std::abs(wrap_angle(from_text->odometry->theta - from_bag->odometry->theta)), 1e-3) << count;
  }
  EXPECT_EQ(count, 756U);
}

TEST(SharedRecordings, TheLowCostLogsHaveTheirScans) {
  const std::string lowcost = test::recorded_data("lowcost") + "/";
  if (lowcost == "/") GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  const auto expect = [&](const char* file, std::size_t scans, std::size_t odometry) {
    const Content content = read_content(lowcost + file);
    EXPECT_EQ(content.scans, scans) << file;
    EXPECT_EQ(content.odometry, odometry) << file;
    EXPECT_EQ(content.damages, 0U) << file;
  };
  expect("rplidar-a1-16m.log.gz", 3936, 3936 - 210);
  expect("rplidar-a1-14m.log.gz", 237, 235);
  expect("breezy-exp1.dat.gz", 756, 756);
  expect("ydlidar-x4-a.dat.gz", 213, 213);
  expect("ydlidar-x4-c.dat.gz", 520, 520);
}

TEST(SharedRecordings, TheOldFormatIsRefusedByName) {
  const std::string path = test::recorded_data("bags/rosrecord-v1.2-original.bag");
  if (path.empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  try {
    read_content(path);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("ROSRECORD V1.2"), std::string::npos) << error.what();
  }
}

// What is said of a log that contradicts itself is no false alarm on recordings that do not.
TEST(SharedRecordings, ContradictThemselvesNowhere) {
  if (test::recorded_data("bags").empty()) GTEST_SKIP() << "no recorded data ($PHASESCAN_DATA)";
  for (const char* name :
       {"bags/breezy-exp1.bag", "bags/breezy-exp1.mcap", "bags/hokuyo-demo.bag", "bags/hokuyo-demo.mcap",
        "carmen/intel-corrected.log.gz", "lowcost/breezy-exp1.dat.gz", "lowcost/rplidar-a1-14m.log.gz",
        "lowcost/rplidar-a1-16m.log.gz", "lowcost/ydlidar-x4-a.dat.gz", "lowcost/ydlidar-x4-c.dat.gz"}) {
    const auto log = open_log(test::recorded_data(name));
    std::size_t scans = 0;
    while (log->next()) ++scans;
    EXPECT_GT(scans, 0U) << name;
    for (const LogRemark& remark : log->remarks()) ADD_FAILURE() << name << ": " << remark.text;
  }
}

}  // namespace
}  // namespace phasescan::shared_recordings_test
