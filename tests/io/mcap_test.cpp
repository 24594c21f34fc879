// MCAP as it is read: chunks or none, every compression, both message encodings, checksums.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "phasescan/io/error.hpp"
#include "support/recordings.hpp"
#include "support/temp.hpp"

namespace phasescan::mcap_test {
namespace {

using namespace test;

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

}  // namespace
}  // namespace phasescan::mcap_test
