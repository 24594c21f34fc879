// The quick ways of reading numbers and scans give, to the bit, what the slow ones give.
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstring>

#include "io/json.hpp"
#include "core/random.hpp"
#include "phasescan/io/error.hpp"
#include "io/number.hpp"

namespace phasescan::quick_parse_test {
namespace {

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

TEST(QuickParse, PlainDecimalsAreWhatFromCharsReads) {
  Random random(7);
  int read = 0;
  for (int round = 0; round < 200'000; ++round) {
    std::string text = random.below(4) == 0 ? "-" : "";
    for (std::uint64_t i = random.below(12); i > 0; --i) text += static_cast<char>('0' + random.below(10));
    if (random.below(3) > 0) text += '.';
    for (std::uint64_t i = random.below(10); i > 0; --i) text += static_cast<char>('0' + random.below(10));
    if (random.below(20) == 0) text += "e3";
    const std::string tail = random.below(2) == 0 ? "" : ",7";
    double quick = 0.0, slow = 0.0;
    const std::string line = text + tail;
    const char* const end = read_plain_decimal(line.data(), line.data() + line.size(), quick);
    if (end == nullptr) continue;
    ++read;
    const auto expected = std::from_chars(line.data(), line.data() + line.size(), slow);
    ASSERT_EQ(expected.ec, std::errc{}) << line;
    ASSERT_EQ(end, expected.ptr) << line;
    ASSERT_EQ(bits_of(quick), bits_of(slow)) << line;
  }
  EXPECT_GT(read, 50'000);
}

TEST(QuickParse, WhatNeedsCareIsLeftToFromChars) {
  for (const std::string text :
       {"", "-", ".5", "1.", "1e5", "1.5E3", "nan", "inf", "+1", "1234567890123456", "0.1234567890123456"}) {
    double value = 0.0;
    EXPECT_EQ(read_plain_decimal(text.data(), text.data() + text.size(), value), nullptr) << text;
  }
  EXPECT_EQ(parse_number<double>("0.1234567890123456"), 0.1234567890123456);
  EXPECT_FALSE(parse_number<double>(""));
  EXPECT_FALSE(parse_number<double>("1.5x"));
}

Scan slowly(const std::string& text) {
  const std::string file = "f";
  const json::Place place{file, 1, text};
  return json::scan_from(json::parse(place), place);
}

/// Nothing where the quick way leaves the text to the slow one.
std::optional<Scan> quickly(const std::string& text) {
  const std::string file = "f";
  json::ScanArrays arrays;
  std::string rest;
  if (!json::take_scan_arrays(text, arrays, rest)) return std::nullopt;
  return json::scan_from(json::parse({file, 1, rest}), {file, 1, text}, arrays);
}

void expect_same(const Scan& a, const Scan& b) {
  ASSERT_EQ(a.states, b.states);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_TRUE(!a.is_hit(i) || a.ranges[i] == b.ranges[i]) << i;
  }
  EXPECT_EQ(a.angles, b.angles);
  EXPECT_EQ(a.intensities, b.intensities);
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.geometry.angle_min, b.geometry.angle_min);
}

TEST(QuickParse, ArraysOfAScanAreThoseOfTheTree) {
  const std::string head = R"({"angle_min": -1.5, "angle_increment": 0.5, "stamp": 1700000000.123456789, )";
  for (const std::string& text : {
           head + R"("ranges": [1, 2.5, null, 0, 1e2, 1e9, 0.30000001192092896, -1]})",
           head + R"("ranges":[],"x":["ranges",1]})",
           head + R"( "ranges" : [ 1 , 2 ] , "intensities" : [ 3 , 4.5 ] })",
           head + R"("nested": {"ranges": [9, 9]}, "ranges": [1, 2], "intensities": null})",
           std::string(R"({"angles": [0.1, 0.2], "ranges": [1, 2], "odometry": {"x": 1, "y": 2, "theta": 3}})"),
       }) {
    SCOPED_TRACE(text);
    const auto quick = quickly(text);
    ASSERT_TRUE(quick);
    expect_same(*quick, slowly(text));
  }
}

TEST(QuickParse, WhatIsNotPlainGoesTheSlowWay) {
  for (const std::string array : {"[1, NaN]", "[1, \"inf\"]", "[01]", "[.5]", "[1.]", "[1,]", "[1 2]", "[1, [2]]",
                                  "[1e999]", "[nul]", "[1", "[+1]", "null", "7"}) {
    EXPECT_FALSE(quickly("{\"angle_min\": 0, \"angle_increment\": 1, \"ranges\": " + array + "}")) << array;
  }
  EXPECT_FALSE(quickly(R"({"ranges": [1], "ranges": [2]})"));
  EXPECT_FALSE(quickly(R"({"ran\u0067es": [1]})"));
}

}  // namespace
}  // namespace phasescan::quick_parse_test
