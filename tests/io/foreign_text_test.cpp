// Text that needs a word of the user, JSON as others write it, and files that are not for us.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/beam_geometry.hpp"
#include "io/clock_stamp.hpp"
#include "phasescan/core/pose2.hpp"
#include "support/read_text.hpp"

namespace phasescan::foreign_text_test {
namespace {

using test::read_text;
using test::ReadText;
using test::refusal_of;
using ::testing::HasSubstr;

std::string matrix(int rows, int columns, double scale, bool commas) {
  std::string text;
  for (int k = 0; k < rows; ++k) {
    for (int i = 0; i < columns; ++i)
      text += (i ? (commas ? ", " : " ") : "") + std::to_string(scale * (1.0 + 0.01 * ((k * 7 + i * 3) % 100)));
    text += '\n';
  }
  return text;
}

std::string integers(int rows, int columns) {
  std::string text;
  for (int k = 0; k < rows; ++k) {
    for (int i = 0; i < columns; ++i)
      text += (i ? " " : "") + std::to_string(1000 + (k * k * 7919 + i * i * 31 + k * i) % 500);
    text += '\n';
  }
  return text;
}

TEST(Matrix, WithoutAHeaderIsRefusedWithWhatToType) {
  for (const std::string& text : {matrix(12, 897, 1.0, true), matrix(12, 897, 1000.0, false), matrix(1, 70, 1.0, true),
                                  integers(12, 363), integers(12, 707)}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("numbers a line and no header; expected --columns ranges"));
  }
  EXPECT_THAT(refusal_of("5682500 617 658 692 519\n5682927 617 658 692 519\n"), HasSubstr("--columns stamp,ranges"));
  EXPECT_THAT(refusal_of("0.5 , 2383.0, 47\n1.2 , 2373.0, 47\n"), HasSubstr("--columns angle_deg,range_mm,quality"));
}

TEST(Matrix, BehindClockTimesIsRefusedWithWhatToType) {
  EXPECT_THAT(refusal_of("13:12:54.032452, 15, 136.28125, 413.75\n13:12:54.033942, 15, 94.21875, 945.25\n"),
              HasSubstr("4 numbers a line and no header; expected --columns with their names, for example --columns "
                        "stamp,quality,angle_deg,range_mm"));
  EXPECT_THAT(refusal_of("2023-05-01T13:12:54Z,136.3,413.75\n2023-05-01T13:12:55Z,94.2,945.25\n"),
              HasSubstr("--columns stamp,angle_deg,range_mm"));
  EXPECT_THAT(refusal_of("13:12:54.0 1.5 1.6 1.7 1.8 1.9\n13:12:54.1 1.5 1.6 1.7 1.8 1.9\n"),
              HasSubstr("6 numbers a line and no header; expected --columns stamp,ranges and the field of view"));
  EXPECT_THAT(refusal_of("13:12:54.0, 1.5\n13:12:54.1, 1.6\n"), HasSubstr("is of no known format"));
}

TEST(Matrix, IsReadWithNamesAndGeometry) {
  LogOptions options;
  options.columns = "ranges";
  ReadText read = read_text(matrix(12, 897, 1.0, true), options);
  ASSERT_EQ(read.entries.size(), 12U);
  EXPECT_NEAR(read.entries[0].scan.geometry.angle_increment, kTwoPi / 897, 1e-12);
  EXPECT_TRUE(read.has_remark("assumed angles"));
  EXPECT_TRUE(read.has_remark("assumed stamps"));
  options.columns = "stamp_ms,ranges_mm";
  options.beams.field_of_view = kPi;
  read = read_text("1000 1000 2000 3000 4000 5000\n1200 1000 2000 3000 4000 5000\n", options);
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_NEAR(read.entries[0].scan.angle(0), -kPi / 2, 1e-12);
  EXPECT_NEAR(read.entries[0].scan.angle(4), kPi / 2, 1e-12);
  EXPECT_EQ(read.entries[1].scan.stamp - read.entries[0].scan.stamp, 200'000'000);
  options.beams.clockwise = true;
  EXPECT_NEAR(read_text("1000 1000 2000 3000\n", options).entries.at(0).scan.angle(0), kPi / 2, 1e-12);
  options.beams.angle_increment = 0.1;
  EXPECT_THAT(refusal_of("1000 1000 2000 3000\n", options), HasSubstr("contradict each other for 3 beams"));
}

TEST(Matrix, OneLineWithoutItsEndIsReadWhereItIsAllThereIs) {
  LogOptions options;
  options.columns = "ranges";
  EXPECT_EQ(read_text("1.5, 2.5, 3.5", options).entries.size(), 1U);
  const ReadText two = read_text("1.5, 2.5, 3.5\n1.5, 2.5", options);
  EXPECT_EQ(two.entries.size(), 1U);
  EXPECT_EQ(two.damages.size(), 1U);
}

TEST(Columns, StampsInAGivenUnit) {
  LogOptions options;
  options.columns = "stamp,ranges";
  options.stamp_unit = "us";
  const ReadText read = read_text("1000 1 2 3\n3000 1 2 3\n", options);
  EXPECT_EQ(read.entries.at(1).scan.stamp - read.entries.at(0).scan.stamp, 2'000'000);
  LogOptions unit;
  unit.stamp_unit = "us";
  EXPECT_THAT(refusal_of("{\"angle_min\": 0, \"angle_increment\": 1, \"ranges\": [1]}\n", unit),
              HasSubstr("states its own angles and times"));
}

TEST(Columns, NoRangeIsLargerThanAnySensorSees) {
  LogOptions options;
  options.columns = "ranges";
  const ReadText read = read_text("1 99999999999999999999999999999999999999 2\n", options);
  EXPECT_EQ(read.entries.at(0).scan.states[1], BeamState::kInvalid);
}

TEST(Columns, PointsAreBeams) {
  LogOptions options;
  options.columns = "scan,x,y";
  const ReadText read = read_text("0,1,0\n0,0,2\n1,3,0\n1,0,4\n", options);
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_FLOAT_EQ(read.entries[0].scan.ranges[1], 2.0F);
  EXPECT_NEAR(read.entries[0].scan.angle(1), kPi / 2, 1e-6);
}

TEST(Columns, AnglesTakenAsCounterClockwiseAreSaid) {
  LogOptions options;
  options.columns = "angle_deg,range_mm";
  const std::string text = "10 1000\n100 2000\n350 1000\n10 1000\n";
  EXPECT_TRUE(read_text(text, options).has_remark("assumed direction"));
  options.beams.clockwise = true;
  const ReadText clockwise = read_text(text, options);
  EXPECT_FALSE(clockwise.has_remark("assumed direction"));
  EXPECT_NEAR(clockwise.entries.at(0).scan.angle(1), deg_to_rad(-100.0), 1e-6);
  EXPECT_EQ(clockwise.entries.size(), 2U);
}

TEST(ClockStamps, AreReadExactlyAndRunOverMidnight) {
  EXPECT_EQ(parse_clock_stamp("00:00:01.5"), 1'500'000'000);
  EXPECT_EQ(parse_clock_stamp("13:12:54.032452001"), (13LL * 3600 + 12 * 60 + 54) * 1'000'000'000 + 32'452'001);
  EXPECT_EQ(parse_clock_stamp("1970-01-02T00:00:00Z"), 86'400'000'000'000);
  EXPECT_EQ(parse_clock_stamp("1970/01/01/02:03:26.983000"), 7'406'983'000'000);
  EXPECT_EQ(parse_clock_stamp("2023-05-01 12:00:00+02:00"), 1'682'935'200'000'000'000);
  EXPECT_EQ(parse_clock_stamp("2023-05-01T12:00:00-0130"), 1'682'947'800'000'000'000);
  for (const char* bad : {"", "1", "13:12", "24:00:00", "13:60:00", "2023-02-30T00:00:00", "2023-5-1T00:00:00",
                          "13:12:54.", "2023-05-01", "13:12:54 x", "2023-05-01T12:00:00+2", "99999-01-01T00:00:00"})
    EXPECT_EQ(parse_clock_stamp(bad), std::nullopt) << bad;
  LogOptions options;
  options.columns = "stamp,angle_deg_cw,range_mm";
  const ReadText read =
      read_text("23:59:59.5, 10, 1000\n23:59:59.6, 350, 1000\n00:00:00.5, 10, 1000\n00:00:00.6, 300, 1000\n", options);
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[1].scan.stamp - read.entries[0].scan.stamp, 1'000'000'000);
}

TEST(RosTopicEchoP, StampsAreNanosecondsWhateverTheirSize) {
  const std::string header =
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angle_min,"
      "field.angle_increment,field.ranges0,field.ranges1\n";
  const ReadText read =
      read_text(header + "124692121616,1,124600000000,laser,0,0.1,1,2\n124992121616,2,124900000000,laser,0,0.1,1,2\n");
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.stamp, 124'600'000'000) << "when it was measured, not when it was received";
  EXPECT_EQ(read.entries[1].scan.stamp - read.entries[0].scan.stamp, 300'000'000);
}

TEST(BagToCsv, ArraysStandInQuotes) {
  const ReadText read = read_text(
      "time,.header.seq,.header.stamp.secs,.header.stamp.nsecs,.header.frame_id,.angle_min,.angle_max,.angle_increment,"
      ".range_min,.range_max,.ranges,.intensities\n"
      "1970/01/01/02:03:26.983000,0,206,977000000,base_scan,0.0,0.2,0.1,0.12,3.5,\"(inf, 1.5, 2.5)\",\"(0.0, 1.0, nan)\"\n"
      "1970/01/01/02:03:27.983000,0,207,977000000,base_scan,0.0,0.2,0.1,0.12,3.5,\"[1.0, 1.5]\",\"()\"\n"
      "1970/01/01/02:03:27.983000,0,207,977000000,base_scan,0.0,0.2,0.1,0.12,3.5,\"(1.0, x)\",\"()\"\n");
  ASSERT_EQ(read.entries.size(), 2U);
  EXPECT_EQ(read.entries[0].scan.stamp, 206'977'000'000);
  EXPECT_EQ(read.entries[0].scan.states[0], BeamState::kOutOfRange);
  EXPECT_EQ(read.entries[0].scan.ranges[1], 1.5F);
  EXPECT_EQ(read.entries[0].scan.intensities, (std::vector<float>{0.0F, 1.0F, 0.0F}));
  EXPECT_EQ(read.entries[1].scan.size(), 2U);
  EXPECT_EQ(read.damages.size(), 1U);
}

std::string scan_with(const std::string& field) {
  return "{" + field + (field.empty() ? "" : ", ") +
         "\"angle_min\": 0, \"angle_increment\": 0.1, \"ranges\": [1, 2, 3]}";
}

TEST(Json, StampsAsOthersWriteThem) {
  const std::pair<const char*, Stamp> cases[] = {
      {"\"header\": {\"stamp\": {\"sec\": 5, \"nanosec\": 7}, \"frame_id\": \"laser\"}", 5'000'000'007},
      {"\"header\": {\"stamp\": {\"secs\": 5, \"nsecs\": 7}}", 5'000'000'007},
      {"\"header\": {\"stamp\": 1282836370.970876375}", 1'282'836'370'970'876'375},
      {"\"timestamp\": 1700000000.25", 1'700'000'000'250'000'000},
      {"\"timestamp\": 1700000000250", 1'700'000'000'250'000'000},
      {"\"timestamp\": 1700000000250000001", 1'700'000'000'250'000'001},
      {"\"timestamp\": {\"sec\": 5, \"nsec\": 7}", 5'000'000'007},
      {"\"timestamp\": \"1970-01-01T00:00:05Z\"", 5'000'000'000},
      {"\"stamp\": 5.5, \"timestamp\": 9", 5'500'000'000},
  };
  for (const auto& [field, stamp] : cases)
    EXPECT_EQ(read_text(scan_with(field) + "\n").entries.at(0).scan.stamp, stamp) << field;
  const ReadText bad = read_text(scan_with("\"stamp\": \"yesterday\"") + "\n" + scan_with("\"stamp\": 1") + "\n");
  EXPECT_EQ(bad.damages.size(), 1U);
}

TEST(Json, WithoutStampsAScanEveryTenthOfASecondIsAssumedAndSaid) {
  const ReadText read = read_text(scan_with("") + "\n" + scan_with("") + "\n" + scan_with("") + "\n");
  ASSERT_EQ(read.entries.size(), 3U);
  EXPECT_EQ(read.entries[2].scan.stamp, 200'000'000);
  EXPECT_TRUE(read.has_remark("assumed stamps"));
  const ReadText from_zero = read_text(scan_with("") + "\n" + scan_with("\"stamp\": 0.25") + "\n");
  EXPECT_EQ(from_zero.entries.at(1).scan.stamp, 250'000'000);
  EXPECT_FALSE(from_zero.has_remark("assumed stamps"));
}

TEST(Json, AnArrayOfScansOnOneLineOrMany) {
  const std::string a = scan_with("\"stamp\": 1"), b = scan_with("\"stamp\": 2, \"note\": \"} \\\" {\"");
  for (const std::string& text :
       {"[" + a + "," + b + "]", "[\n" + a + ",\n" + b + "\n]\n", " [ " + a + " , " + b + " ] "}) {
    const ReadText read = read_text(text);
    ASSERT_EQ(read.entries.size(), 2U) << text;
    EXPECT_TRUE(read.damages.empty());
    EXPECT_EQ(read.entries[1].scan.stamp, 2'000'000'000);
  }
  const std::string text = "[" + a + "," + b + "]";
  for (std::size_t size = text.find('{') + 1; size < text.size(); ++size) {
    const ReadText cut = read_text(text.substr(0, size));
    EXPECT_EQ(cut.entries.size(), size >= text.size() - 1 ? 2U : size > a.size() ? 1U : 0U) << size;
  }
}

TEST(ForeignFiles, AreNamedWithWhatToDo) {
  EXPECT_THAT(refusal_of("version https://git-lfs.github.com/spec/v1\noid sha256:aa\nsize 3\n"),
              HasSubstr("git lfs pull"));
  EXPECT_THAT(refusal_of(std::string("\x8d") + "CSensoryFrame\x02\x01"), HasSubstr("MRPT rawlog; `rawlog-edit"));
  EXPECT_THAT(refusal_of(std::string("\x94") + "CObservationOdometry\x02"), HasSubstr("MRPT rawlog"));
  EXPECT_THAT(refusal_of("PK\x03\x04 rest"), HasSubstr("zip archive"));
  EXPECT_THAT(refusal_of("# .PCD v0.7\n"), HasSubstr("point cloud"));
  const test::TempFolder folder;
  folder.put("x_0.db3", "version https://git-lfs.github.com/spec/v1\noid sha256:aa\nsize 3\n");
  const ReadText read = test::read_log(folder.path());
  EXPECT_TRUE(read.entries.empty());
  EXPECT_THAT(read.damages.at(0).text, HasSubstr("git lfs pull"));
}

using Angle = std::optional<double>;
constexpr std::nullopt_t kNot = std::nullopt;

BeamFan fan(Angle field_of_view, Angle angle_min, Angle increment, bool clockwise, std::size_t count) {
  return fan_of(BeamGeometry{field_of_view, angle_min, increment, clockwise}, count);
}

TEST(BeamGeometry, FieldOfViewIncrementAndDirection) {
  EXPECT_NEAR(fan(kNot, kNot, kNot, false, 360).angle_increment, kTwoPi / 360, 1e-12);
  EXPECT_EQ(fan(kNot, kNot, kNot, false, 360).angle_min, 0.0);
  const BeamFan turn = fan(kTwoPi, kNot, kNot, true, 360);
  EXPECT_NEAR(turn.angle_increment, -kTwoPi / 360, 1e-12);
  EXPECT_EQ(turn.angle_min, 0.0);
  const BeamFan half = fan(kPi, kNot, kNot, false, 181);
  EXPECT_NEAR(half.angle_increment, kPi / 180, 1e-12);
  EXPECT_NEAR(half.angle_min, -kPi / 2, 1e-12);
  EXPECT_NEAR(fan(kNot, kNot, deg_to_rad(0.5), true, 541).angle_min, deg_to_rad(135.0), 1e-9);
  EXPECT_NEAR(fan(kNot, 0.3, 0.01, false, 5).angle_min, 0.3, 1e-12);
  EXPECT_NEAR(fan(kNot, kNot, kTwoPi / 720, false, 720).angle_min, 0.0, 1e-12) << "a full turn by its steps";
  EXPECT_THROW(fan(kPi, kNot, deg_to_rad(0.5), false, 181), std::invalid_argument);
  EXPECT_NO_THROW(fan(kPi, kNot, deg_to_rad(1.0), false, 181));
}

}  // namespace
}  // namespace phasescan::foreign_text_test
