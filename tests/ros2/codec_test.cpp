// Messages as bytes: round trips, known bytes, bytes that hold something else.
#include "ros2/codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "io/ros_encode.hpp"
#include "ros2/node_support.hpp"
#include "support/paths.hpp"

namespace phasescan::ros2::codec_test {
namespace {

template <class M>
void expect_round_trip(std::uint64_t seed) {
  const M message = random_message<M>(seed);
  const std::vector<std::uint8_t> bytes = encode(message);
  EXPECT_EQ(encode(decode<M>(bytes)), bytes) << Message<M>::type << " of seed " << seed;
  // Cut anywhere: an error, never a read beyond the end. Only what pads the end may be missing.
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_THROW(decode<M>(Bytes(bytes.data(), n)), DecodeError) << Message<M>::type << " cut to " << n;
}

TEST(Codec, WhatIsWrittenIsReadBack) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for_each_topic_type([seed]<class M>() { expect_round_trip<M>(seed); });
  }
}

TEST(Codec, BytesOfAScanAreThoseOfTheLogWriter) {
  // Two writers of one format: the logs' own and the one that is made from the description.
  const LaserScan scan = random_message<LaserScan>(7);
  ByteWriter other;
  ros::encode(scan, other);
  EXPECT_EQ(encode(scan), other.bytes());
}

TEST(Codec, KnownBytes) {
  const Header header{1'500'000'000, "ab"};
  const TFMessage none{};
  EXPECT_EQ(encode(none), (std::vector<std::uint8_t>{0, 1, 0, 0, 0, 0, 0, 0}));
  const PoseStamped pose{header, {{1.0, 0.0, 0.0}, {}}};
  const std::vector<std::uint8_t> bytes = encode(pose);
  const std::vector<std::uint8_t> begin = {0, 1, 0, 0, 1, 0, 0, 0, 0x00, 0x65, 0xcd, 0x1d, 3, 0, 0, 0, 'a', 'b', 0};
  ASSERT_EQ(bytes.size(), 4U + 16U + 56U);  // stamp 8, text 4 + 3, up to a multiple of 8, seven doubles
  EXPECT_TRUE(std::equal(begin.begin(), begin.end(), bytes.begin()));
  EXPECT_EQ(bytes[4 + 16 + 6], 0xf0);  // of 1.0
  EXPECT_EQ(bytes[4 + 16 + 7], 0x3f);
}

TEST(Codec, StampsBefore1970AndWholeSeconds) {
  for (const Stamp stamp : {Stamp{0}, Stamp{-1}, Stamp{-1'000'000'000}, Stamp{999'999'999}, at(12.75)}) {
    EXPECT_EQ(decode<PoseStamped>(encode(PoseStamped{{stamp, ""}, {}})).header.stamp, stamp);
  }
}

TEST(Codec, BigEndianIsRead) {
  // String "hi" by hand.
  const std::vector<std::uint8_t> bytes = {0, 0, 0, 0, 0, 0, 0, 3, 'h', 'i', 0};
  EXPECT_EQ(decode<String>(bytes).data, "hi");
}

TEST(Codec, CountsThatTheBytesDoNotHoldTakeNoMemory) {
  std::vector<std::uint8_t> bytes = encode(TFMessage{});
  std::fill(bytes.begin() + 4, bytes.begin() + 8, std::uint8_t{0xff});
  EXPECT_THROW(decode<TFMessage>(bytes), DecodeError);
  EXPECT_THROW(decode<TFMessage>(std::vector<std::uint8_t>{0, 3, 0, 0, 0, 0, 0, 0}), DecodeError);  // parameter list
  EXPECT_THROW(decode<String>(std::vector<std::uint8_t>{0, 1, 0, 0, 0xff, 0xff, 0xff, 0x7f, 0}), DecodeError);
}

TEST(Codec, AnyBytesAreAMessageOrAnError) {
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    std::vector<std::uint8_t> bytes = {0, static_cast<std::uint8_t>(random.below(2)), 0, 0};
    for (auto n = random.below(200); n > 0; --n)
      bytes.push_back(static_cast<std::uint8_t>(random.chance(0.6) ? 0 : random.bits()));
    for_each_topic_type([&]<class M>() {
      try {
        const M message = decode<M>(bytes);
        EXPECT_NO_THROW(encode(message));
      } catch (const DecodeError&) {
      }
    });
  }
}

TEST(Codec, DefinitionsAreThoseOfTheLogWriter) {
  EXPECT_EQ(definition<String>(), "string data\n");
  const std::string scan = definition<LaserScan>();
  const std::string other = ros::message_definition("sensor_msgs/msg/LaserScan");
  EXPECT_EQ(scan.substr(0, scan.find('=')), other.substr(0, other.find('=')));
}

TEST(Codec, IdlOfTheTreeIsTheOneOfTheDescriptions) {
  std::ifstream file(test::source_dir() + "/src/dds/ros_messages.idl");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.erase(0, text.find("module "));
  EXPECT_EQ(text, idl());
}

}  // namespace
}  // namespace phasescan::ros2::codec_test
