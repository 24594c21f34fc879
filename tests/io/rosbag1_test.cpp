// rosbag1: every compression, with and without an index; damage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phasescan/io/error.hpp"
#include "support/recordings.hpp"
#include "support/temp.hpp"

namespace phasescan::rosbag1_test {
namespace {

using namespace test;

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

}  // namespace
}  // namespace phasescan::rosbag1_test
