#include "io/pairs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/random.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/io/scan_json.hpp"
#include "support/temp.hpp"

namespace phasescan::pairs_test {
namespace {

using ::testing::HasSubstr;

Scan random_scan(Random& random, std::size_t beams) {
  std::vector<float> raw(beams);
  for (float& r : raw) r = static_cast<float>(random.uniform(-0.5, 7.0));
  for (std::size_t i = 0; i < beams; i += 7) raw[i] = 0.0F;
  for (std::size_t i = 3; i < beams; i += 11) raw[i] = NAN;
  Scan scan = make_scan(raw, {random.uniform(-3, 3), random.uniform(-0.1, -0.001), 0.15, 6.0});
  scan.stamp = 1'700'000'000'123'456'789 + static_cast<Stamp>(random.below(1'000'000'000));
  scan.time_increment = random.uniform(0.0, 0.01);
  return scan;
}

void expect_same(const Scan& a, const Scan& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.geometry.angle_min, b.geometry.angle_min);
  EXPECT_EQ(a.geometry.angle_increment, b.geometry.angle_increment);
  EXPECT_EQ(a.geometry.range_min, b.geometry.range_min);
  EXPECT_EQ(a.geometry.range_max, b.geometry.range_max);
  EXPECT_EQ(a.time_increment, b.time_increment);
  EXPECT_EQ(a.states, b.states);
  EXPECT_EQ(a.angles, b.angles);
  EXPECT_EQ(a.intensities, b.intensities);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.is_hit(i)) {
      EXPECT_EQ(a.ranges[i], b.ranges[i]);
    }
  }
}

TEST(ScanJson, EveryScanReadsBackTheSameToTheLastBit) {
  Random random(1);
  for (const std::size_t beams : {0, 1, 2, 360, 1000}) {
    Scan scan = random_scan(random, beams);
    expect_same(scan, parse_scan_json(format_scan_json(scan), "x"));
    scan.intensities.assign(beams, 0.25F);
    for (std::size_t i = 0; i < beams; ++i) scan.angles.push_back(static_cast<float>(random.uniform(-3, 3)));
    scan.geometry.angle_min = scan.geometry.angle_increment = 0.0;
    expect_same(scan, parse_scan_json(format_scan_json(scan), "x"));
  }
}

TEST(ScanJson, TheReasonOfAMissingBeamSurvives) {
  const Scan scan = parse_scan_json(
      R"({"angle_min": 0, "angle_increment": 0.1, "range_min": 0.15, "range_max": 6,
          "ranges": [1.5, 0, null, NaN, Infinity, -Infinity, 7, 0.1, -3]})",
      "x");
  using enum BeamState;
  const std::vector<BeamState> expected{kHit,     kNoReturn,   kInvalid, kInvalid, kOutOfRange,
                                        kTooNear, kOutOfRange, kTooNear, kInvalid};
  EXPECT_EQ(scan.states, expected);
  EXPECT_EQ(parse_scan_json(format_scan_json(scan), "x").states, expected);
}

std::string message_of(std::string_view text) {
  try {
    parse_scan_json(text, "f.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScanJson, AnErrorNamesFileAndLineAndWhatWasExpected) {
  EXPECT_THAT(message_of("{\n \"angle_min\": 0,\n \"angle_increment\": 0,\n \"ranges\": [1,2]}"),
              HasSubstr("f.json:3: \"angle_increment\" is 0"));
  EXPECT_THAT(message_of("{\"angle_min\": 0,\n \"angle_increment\": 1,\n \"ranges\": [1,\"a\"]}"),
              HasSubstr("f.json:3: \"ranges\"[1] is 'a'; expected"));
  EXPECT_THAT(message_of("{\"angle_min\": 0,\n \"ranges\": [1,2"), HasSubstr("f.json:2: the JSON text is cut off"));
  EXPECT_THAT(message_of("[1,2]"), HasSubstr("expected a scan object"));
  EXPECT_THAT(message_of("{\"angle_min\": 0, \"angle_increment\": 1}"), HasSubstr("\"ranges\" is missing"));
  EXPECT_THAT(message_of("{\"angle_increment\": 1, \"ranges\": [1]}"), HasSubstr("\"angle_min\" is missing"));
  EXPECT_THAT(message_of("{\"angle_min\": 1e99, \"angle_increment\": 1, \"ranges\": [1]}"),
              HasSubstr("not a possible angle"));
  EXPECT_THAT(message_of("{\"angle_min\": 0, \"angle_increment\": 1, \"ranges\": [1e999]}"), HasSubstr("too large"));
  EXPECT_THAT(message_of("{\"angles\": [1], \"ranges\": [1, 2]}"), HasSubstr("expected one for each of the 2 ranges"));
}

ScanPair a_pair(std::uint64_t seed, bool truth) {
  Random random(seed);
  ScanPair pair;
  pair.id = "id \"" + std::to_string(seed) + "\"\n";
  pair.dataset = "set";
  pair.cls = truth ? "large" : "none";
  pair.reference = random_scan(random, 50);
  pair.scan = random_scan(random, 60);
  if (truth) {
    pair.truth = Pose2{0.1, -0.2, 3.0};
    pair.overlap = 0.7;
    pair.information = (Eigen::Matrix3d() << 1, 2, 3, 2, 5, 6, 3, 6, 1.0 / 3).finished();
  }
  return pair;
}

TEST(Pairs, PlainAndPackedFilesReadBackTheSame) {
  const test::TempFolder folder;
  for (const char* name : {"p.jsonl", "p.jsonl.gz"}) {
    PairWriter writer(folder / name);
    for (std::uint64_t i = 0; i < 5; ++i) writer.write(a_pair(i, i % 2 == 0));
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << "half a file is visible";
    writer.commit();
    const auto pairs = read_pairs(folder / name);
    ASSERT_EQ(pairs.size(), 5U);
    for (std::uint64_t i = 0; i < 5; ++i) {
      const ScanPair expected = a_pair(i, i % 2 == 0);
      EXPECT_EQ(pairs[i].id, expected.id);
      EXPECT_EQ(pairs[i].cls, expected.cls);
      EXPECT_EQ(pairs[i].truth.has_value(), expected.truth.has_value());
      if (expected.truth) {
        EXPECT_EQ(pairs[i].truth->theta, expected.truth->theta);
      }
      EXPECT_EQ(pairs[i].overlap, expected.overlap);
      EXPECT_EQ(pairs[i].information, expected.information);
      expect_same(pairs[i].reference, expected.reference);
      expect_same(pairs[i].scan, expected.scan);
    }
  }
}

TEST(Pairs, ABadLineIsToldAndTheRestGoesOn) {
  const test::TempFolder folder;
  const std::string good = format_pair(a_pair(1, true));
  PairReader reader(
      folder.put("p.jsonl", good + "\n\n{\"id\": 3}\nnonsense\n" + good + "\n" + good.substr(0, good.size() / 2)));
  std::vector<long> good_lines, bad_lines;
  while (const auto line = reader.next()) (line->pair ? good_lines : bad_lines).push_back(line->line);
  EXPECT_EQ(good_lines, (std::vector<long>{1, 5}));
  EXPECT_EQ(bad_lines, (std::vector<long>{3, 4, 6}));
}

TEST(Pairs, BrokenPackedDataIsOneBadLineAfterWhatCouldBeRead) {
  const test::TempFolder folder;
  PairWriter writer(folder / "p.jsonl.gz");
  for (std::uint64_t i = 0; i < 200; ++i) writer.write(a_pair(i, true));
  writer.commit();
  std::filesystem::resize_file(folder / "p.jsonl.gz", std::filesystem::file_size(folder / "p.jsonl.gz") / 2);
  PairReader reader(folder / "p.jsonl.gz");
  int good = 0, bad = 0;
  std::string last;
  while (const auto line = reader.next()) {
    ++(line->pair ? good : bad);
    last = line->error;
  }
  EXPECT_GT(good, 20);
  EXPECT_GE(bad, 1);
  EXPECT_THAT(last, HasSubstr("cut off"));
}

TEST(Pairs, AFileWithoutALineIsAnError) {
  const test::TempFolder folder;
  EXPECT_THROW(read_pairs(folder.put("empty", "")), InputError);
  EXPECT_THROW(read_pairs(folder.put("blank", "\n \n")), InputError);
  EXPECT_THROW(read_pairs(folder / "absent"), InputError);
  EXPECT_THROW(read_pairs(folder.path()), InputError);
}

}  // namespace
}  // namespace phasescan::pairs_test
