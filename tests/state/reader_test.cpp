// Bytes that are read as a state: what was written comes back, and whatever else they are is refused in words.
#include "state/reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "state/writer.hpp"

namespace phasescan {
namespace reader_test {
enum class Weather : std::uint8_t { kSun, kRain, kSnow };
}
template <>
inline constexpr int kStateEnumCount<reader_test::Weather> = 3;

namespace reader_test {

namespace {

using ::testing::HasSubstr;

struct Chain {
  std::shared_ptr<const Chain> next;
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("next", self.next);
  }
};

struct Everything {
  bool flag = false;
  Weather weather = Weather::kSun;
  std::int32_t number = 0;
  double real = 0.0;
  std::string text;
  std::vector<std::uint8_t> bytes;
  std::vector<std::vector<float>> rows;
  std::map<std::string, int> counts;
  std::optional<Pose2> pose;
  std::pair<int, double> pair{};
  std::array<float, 3> three{};
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  std::shared_ptr<const std::string> one, same;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("flag", self.flag);
    v("weather", self.weather);
    v("number", self.number);
    v("real", self.real);
    v("text", self.text);
    v("bytes", self.bytes);
    v("rows", self.rows);
    v("counts", self.counts);
    v("pose", self.pose);
    v("pair", self.pair);
    v("three", self.three);
    v("matrix", self.matrix);
    v("one", self.one);
    v("same", self.same);
  }
};

template <class T>
std::string bytes_of(const T& value) {
  StateWriter writer;
  writer("value", value);
  return std::move(writer.bytes);
}

/// What a reader says of bytes that should be a T; empty where it takes them all.
template <class T>
std::string refusal(const std::string& bytes) {
  StateReader reader(bytes);
  T value{};
  try {
    reader("value", value);
  } catch (const StateFormatError& error) {
    return error.what();
  }
  return reader.at_end() ? "" : "more follows";
}

TEST(StateReader, WhatWasWrittenComesBack) {
  Everything all;
  all.flag = true;
  all.weather = Weather::kSnow;
  all.number = -7;
  all.real = -0.1;
  all.text = std::string("a\0b", 3);
  all.bytes = {0, 255, 3};
  all.rows = {{1.0F}, {}, {2.0F, 3.0F}};
  all.counts = {{"x", 1}, {"", 2}};
  all.pose = Pose2{1.0, 2.0, 3.0};
  all.pair = {4, 5.0};
  all.three = {1.0F, 2.0F, 3.0F};
  all.matrix << 1, 2, 3, 4;
  all.one = all.same = std::make_shared<const std::string>("shared");
  const std::string bytes = bytes_of(all);
  StateReader reader(bytes);
  Everything read;
  reader("value", read);
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(bytes_of(read), bytes);
  EXPECT_EQ(read.text, all.text);
  EXPECT_EQ(read.matrix, all.matrix);
  EXPECT_EQ(read.one, read.same);  // one object, as before
  EXPECT_EQ(*read.one, "shared");
  // Cut off anywhere it is refused.
  for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_NE(refusal<Everything>(bytes.substr(0, n)), "") << n;
  EXPECT_EQ(refusal<Everything>(bytes + "x"), "more follows");
}

TEST(StateReader, NumbersAreLittleEndianWhateverTheMachine) {
  EXPECT_EQ(bytes_of(std::uint32_t{0x01020304}), std::string("\x04\x03\x02\x01"));
  EXPECT_EQ(bytes_of(std::string("ab")), std::string("\x02\0\0\0\0\0\0\0ab", 10));
  EXPECT_EQ(bytes_of(1.0), std::string("\0\0\0\0\0\0\xF0\x3F", 8));
}

TEST(StateReader, ValuesThatDoNotExistAreRefusedByName) {
  EXPECT_THAT(refusal<bool>("\x02"), HasSubstr("value holds neither true nor false"));
  EXPECT_THAT(refusal<Weather>("\x03"), HasSubstr("a value that does not exist"));
  EXPECT_EQ(refusal<Weather>("\x02"), "");
  EXPECT_THAT(refusal<Pose2>(bytes_of(std::array{1.0, std::numeric_limits<double>::quiet_NaN(), 0.0})),
              HasSubstr("a pose that is not finite"));
}

TEST(StateReader, LengthsBeyondTheBytesAreRefusedBeforeAnyMemoryIsTaken) {
  for (const std::uint64_t n : {std::uint64_t{4}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    const std::string claims = bytes_of(n) + "abc";
    EXPECT_THAT(refusal<std::string>(claims), HasSubstr("more than there are bytes")) << n;
    EXPECT_THAT(refusal<std::vector<double>>(claims), HasSubstr("more than there are bytes")) << n;
    EXPECT_THAT(refusal<std::vector<std::string>>(claims), HasSubstr("more than there are bytes")) << n;
    EXPECT_THAT((refusal<std::map<int, int>>(claims)), HasSubstr("more than there are bytes")) << n;
  }
}

TEST(StateReader, ObjectsAreThoseThatWereReadOrTheNext) {
  using Text = std::shared_ptr<const std::string>;
  EXPECT_EQ(refusal<Text>(bytes_of(std::uint32_t{0})), "");
  EXPECT_EQ(refusal<Text>(bytes_of(std::uint32_t{1}) + bytes_of(std::string("x"))), "");
  EXPECT_THAT(refusal<Text>(bytes_of(std::uint32_t{2}) + bytes_of(std::string("x"))),
              HasSubstr("an object that is not there"));
}

TEST(StateReader, ObjectsWithinObjectsEnd) {
  // The reader's own stack would end first: each holds the next.
  const auto chain = [](std::uint32_t length) {
    std::string bytes;
    for (std::uint32_t k = 0; k < length; ++k) bytes += bytes_of(std::uint32_t{1});  // none is complete before the next
    return bytes + bytes_of(std::uint32_t{0});
  };
  EXPECT_EQ(refusal<std::shared_ptr<const Chain>>(chain(10)), "");
  EXPECT_THAT(refusal<std::shared_ptr<const Chain>>(chain(100000)), HasSubstr("without end"));
}

}  // namespace
}  // namespace reader_test
}  // namespace phasescan
