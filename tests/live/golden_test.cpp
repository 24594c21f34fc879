// Bytes written by hand from the makers' documents, or captured, and what they say: independent of the encoders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "live/encode.hpp"
#include "live/rplidar.hpp"
#include "live/wire.hpp"

namespace phasescan::live::golden_test {
namespace {

using namespace testing;

TEST(Golden, Ld06) {
  const auto decoder = decoder_of("ld06");
  const auto bytes =
      from_hex("542C6808AB7EE000E4DC00E2D900E5D500E3D300E4D000E9CD00E4CA00E2C700E9C500E5C200E5C000E5BE823A1A50");
  const Decoded got = decode(*decoder, bytes);
  ASSERT_EQ(got.beams.size(), 12U);
  EXPECT_NEAR(clockwise_deg(got.beams.front()), 324.27, 1e-9);
  EXPECT_NEAR(clockwise_deg(got.beams.back()), 334.70, 1e-9);  // not the 334.61 of whole hundredths of a degree
  EXPECT_NEAR(mm(got.beams[0]), 224, 1e-3);
  EXPECT_NEAR(mm(got.beams[11]), 192, 1e-3);
  EXPECT_EQ(got.beams[0].intensity, 0xE4);
  // The last sample was half a step before the first byte went out: 47 bytes at 230400 baud, 0.948 deg at 2152 deg/s.
  const double sent = 1.0 - 47 * 10 / 230400.0;
  EXPECT_NEAR(stamp_to_seconds(got.beams[11].stamp), sent - 0.5 * (10.43 / 11) / 2152, 1e-8);
  EXPECT_NEAR(stamp_to_seconds(got.beams[0].stamp), sent - 11.5 * (10.43 / 11) / 2152, 1e-8);
}

TEST(Golden, Ld06StartsATurnWhereItsAnglesPassZero) {
  const auto decoder = decoder_of("ld06");
  std::string text = "542C100E3C8C";
  for (int i = 0; i < 12; ++i) text += "E803C8";
  const Decoded got = decode(*decoder, from_hex(text + "0C032F750B"));
  ASSERT_EQ(got.beams.size(), 12U);
  const double expected[] = {359.0, 359.8, 0.6, 1.4, 2.2, 3.0, 3.8, 4.6, 5.4, 6.2, 7.0, 7.8};
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(clockwise_deg(got.beams[i]), expected[i], 1e-9);
    EXPECT_EQ(got.beams[i].mark == TurnMark::kStarts, i == 2);
  }
}

TEST(Golden, Ld14TurnsItsDirectionsByTheRange) {
  const auto decoder = decoder_of("ld14");
  std::string text = "542C100E3C8C";
  for (int i = 0; i < 12; ++i) text += "E803C8";
  const Decoded got = decode(*decoder, from_hex(text + "0C032F750B"));
  ASSERT_EQ(got.beams.size(), 12U);
  EXPECT_NEAR(clockwise_deg(got.beams[0]), 359.0 - 5.692, 1e-3);
}

TEST(Golden, Xv11) {
  const auto decoder = decoder_of("xv11");
  // Captured: packet A0 + 0x1A, 26 * 4 = 104 degrees.
  const Decoded captured = decode(*decoder, from_hex("FABA314A570760005E0736006F0736007F073700AF26"));
  ASSERT_EQ(captured.beams.size(), 4U);
  EXPECT_NEAR(counter_clockwise_deg(captured.beams[0]), 104, 1e-9);
  EXPECT_NEAR(mm(captured.beams[0]), 0x0757, 1e-3);
  EXPECT_EQ(captured.beams[0].intensity, 0x60);
  // Error 35, weak 1439 mm, 1500 mm, error 02.
  const Decoded made = decode(*decoder, from_hex("FAA0004B358000009F45D200DC05B40002800000E204"));
  ASSERT_EQ(made.beams.size(), 4U);
  EXPECT_EQ(made.beams[0].state, BeamState::kNoReturn);
  EXPECT_NEAR(mm(made.beams[1]), 1439, 1e-3);
  EXPECT_NEAR(mm(made.beams[2]), 1500, 1e-3);
  EXPECT_EQ(made.beams[3].state, BeamState::kNoReturn);
  EXPECT_EQ(made.beams[0].mark, TurnMark::kStarts);
  EXPECT_EQ(decoder->counts().packets, 2U);
}

TEST(Golden, Lds01) {
  const auto decoder = decoder_of("lds-01");
  const Decoded got = decode(*decoder, from_hex("FAA0B80BE803D2040000 30x00 E1E1"));
  ASSERT_EQ(got.beams.size(), 6U);
  EXPECT_NEAR(mm(got.beams[0]), 1234, 1e-3);
  EXPECT_EQ(got.beams[0].intensity, 1000);
  EXPECT_EQ(got.beams[1].state, BeamState::kNoReturn);
  EXPECT_NEAR(counter_clockwise_deg(got.beams[0]), 359, 1e-9);  // where the maker's driver puts degree 0
  EXPECT_NEAR(counter_clockwise_deg(got.beams[5]), 354, 1e-9);
}

TEST(Golden, CamsenseCaptured) {
  const auto decoder = decoder_of("camsense-x1");
  const Decoded got =
      decode(*decoder, from_hex("55AA0308EC4D6CC40080000080000080000080000080008106147E06337D0633F6C5493C"));
  ASSERT_EQ(got.beams.size(), 8U);
  EXPECT_NEAR(clockwise_deg(got.beams[0]), 145.69, 5e-3);
  EXPECT_NEAR(clockwise_deg(got.beams[7]), 151.84, 5e-3);
  EXPECT_EQ(got.beams[4].state, BeamState::kNoReturn);
  EXPECT_NEAR(mm(got.beams[5]), 1665, 1e-3);
  EXPECT_NEAR(mm(got.beams[6]), 1662, 1e-3);
  EXPECT_NEAR(mm(got.beams[7]), 1661, 1e-3);
}

TEST(Golden, Delta2) {
  const auto decoder = decoder_of("delta-2a");
  const Decoded got = decode(*decoder, from_hex("AA00130161AD000B820087697846213A0000000462"));
  ASSERT_EQ(got.beams.size(), 2U);
  EXPECT_NEAR(clockwise_deg(got.beams[0]), 270, 1e-9);
  EXPECT_NEAR(clockwise_deg(got.beams[1]), 270 + 22.5 / 2, 1e-9);
  EXPECT_NEAR(mm(got.beams[0]), 2126.5, 1e-3);
  EXPECT_EQ(got.beams[0].intensity, 0x46);
  EXPECT_EQ(got.beams[1].state, BeamState::kNoReturn);
  const Decoded fault = decode(*decoder, from_hex("AA00090061AE000169022C"));
  EXPECT_TRUE(fault.beams.empty());
  ASSERT_EQ(fault.replies.size(), 1U);
  EXPECT_EQ(fault.replies[0].type, 0xAE);
}

TEST(Golden, Ydlidar) {
  const auto x4 = decoder_of("ydlidar-x4");
  const Decoded zero = decode(*x4, from_hex("AA55010153AE53AEAB540000"));
  ASSERT_EQ(zero.beams.size(), 1U);
  EXPECT_EQ(zero.beams[0].mark, TurnMark::kStarts);
  EXPECT_NEAR(rad_to_deg(zero.beams[0].sweep), 348.640625, 1e-9);  // a real division, not a whole one
  const Decoded at_7_hz = decode(*x4, from_hex("AA558D0153AE53AE27540000"));
  EXPECT_EQ(at_7_hz.beams.size(), 1U);  // the check takes the raw type byte
  EXPECT_EQ(decode(*x4, from_hex("AA666F40E2010000")).beams.size(), 0U);
  EXPECT_EQ(x4->counts().packets, 3U);
  EXPECT_EQ(x4->counts().bad, 0U);
}

TEST(Golden, YdlidarWithIntensity) {
  for (const auto& [sensor, intensity] : {std::pair{"ydlidar-tmini", 31}, {"ydlidar-g4b", 287}}) {
    const auto decoder = decoder_of(sensor);
    const Decoded got = decode(*decoder, from_hex("AA550002E56FBD79CC411FE56F20E46F"));
    ASSERT_EQ(got.beams.size(), 2U) << sensor;
    EXPECT_NEAR(mm(got.beams[0]), 7161, 1e-3);
    EXPECT_EQ(got.beams[0].intensity, intensity);
  }
}

TEST(Golden, YdlidarTurnsItsDirectionsByTheRange) {
  for (const auto& [sensor, shift] :
       {std::pair{"ydlidar-x4", -6.762}, {"ydlidar-scl", 1.020}, {"ydlidar-tmini", 0.0}}) {
    const auto decoder = decoder_of(sensor);
    const Decoded got = decode(*decoder, ydlidar_packet(false, 0, 90, 91, std::vector<WireSample>(2, {1000.0}), 2));
    ASSERT_EQ(got.beams.size(), 2U) << sensor;
    EXPECT_NEAR(clockwise_deg(got.beams[0]), 90 + shift, 1e-3) << sensor;
  }
}

TEST(Golden, RplidarRequests) {
  using namespace rplidar;
  EXPECT_EQ(request(kExpress, std::vector<std::uint8_t>(5, 0)), from_hex("A582050000000000 22"));
  EXPECT_EQ(request(kInfo), from_hex("A550"));
  EXPECT_EQ(conf_request(kModeCount), from_hex("A584047000000055"));
  EXPECT_EQ(conf_request(kModeMicroseconds, 1), from_hex("A5840671000000010057"));
  EXPECT_EQ(conf_request(kTypicalMode), from_hex("A584047C00000059"));
  EXPECT_EQ(request(kMotorBoard, std::vector<std::uint8_t>(4, 0)), from_hex("A5FF04000000005E"));
  EXPECT_EQ(request(kRpm, from_hex("5802")), from_hex("A5A802580255"));
  EXPECT_EQ(request(kPwm, from_hex("9402")), from_hex("A5F0029402C1"));
  EXPECT_EQ(request(kExpress, from_hex("0300000000")), from_hex("A58205030000000021"));
}

TEST(Golden, RplidarNodes) {
  const auto decoder = decoder_of("rplidar-a1");
  std::string text = "A55A0500004081 3E9B640000";
  for (int i = 0; i < 6; ++i) text += " 3D0101A00F";  // start, quality 15, 2 deg, 1000 mm
  const Decoded got = decode(*decoder, from_hex(text));
  ASSERT_EQ(got.beams.size(), 2U);  // a node counts once five more behind it are right
  EXPECT_EQ(got.beams[0].state, BeamState::kNoReturn);
  EXPECT_EQ(got.beams[0].intensity, 15);
  EXPECT_NEAR(clockwise_deg(got.beams[0]), (0x649B >> 1) / 64.0, 1e-9);
  EXPECT_EQ(got.beams[1].mark, TurnMark::kStarts);
  EXPECT_NEAR(mm(got.beams[1]), 1000, 1e-3);
  EXPECT_NEAR(clockwise_deg(got.beams[1]), 2, 1e-9);
}

TEST(Golden, RplidarCapsules) {
  const auto decoder = decoder_of("rplidar-a1");
  // Two at 0 and 32 degrees tell how far the head turns during one.
  EXPECT_TRUE(decode(*decoder, from_hex("A55A5400004082 A0500000 80x00 A8500008 80x00")).beams.empty());
  const Decoded got = decode(*decoder, from_hex("AC5C0080A30FA70F48 75x00 A8500008 80x00"));
  ASSERT_EQ(got.beams.size(), 32U);
  EXPECT_NEAR(clockwise_deg(got.beams[0]), 353.0, 1e-9);
  EXPECT_NEAR(mm(got.beams[0]), 1000, 1e-3);
  EXPECT_NEAR(clockwise_deg(got.beams[1]), 354.5, 1e-9);
  EXPECT_NEAR(mm(got.beams[1]), 1001, 1e-3);
  EXPECT_EQ(got.beams[2].state, BeamState::kNoReturn);
}

TEST(Golden, RplidarUltraRanges) {
  std::vector<std::uint8_t> capsule = from_hex("A0500000 EE5540FF EE0500 00 120x00");
  std::vector<rplidar::CapsuleSample> samples;
  rplidar::read_capsule(rplidar::kUltra, capsule, capsule, samples);
  ASSERT_EQ(samples.size(), 96U);
  EXPECT_EQ(samples[0].distance_q2, 4 * 3000U);
  EXPECT_EQ(samples[1].distance_q2, 4 * 3020U);
  EXPECT_EQ(samples[2].distance_q2, 4 * 2988U);
}

TEST(Golden, RplidarUltraDirections) {
  std::vector<std::uint8_t> capsule = from_hex("A0500000 F40200 00 124x00");  // 512 + 2 (0x2F4 - 512) = 1000 mm
  std::vector<rplidar::CapsuleSample> samples;
  rplidar::read_capsule(rplidar::kUltra, capsule, capsule, samples);
  ASSERT_EQ(samples.size(), 96U);
  EXPECT_EQ(samples[0].distance_q2, 4000U);
  EXPECT_NEAR(rad_to_deg(samples[0].shift), -6.657, 5e-4);
  EXPECT_NEAR(rad_to_deg(samples[50].shift), -7.5, 1e-9);  // nothing there
}

TEST(Golden, RplidarUltraDense) {
  std::vector<std::uint8_t> capsule = from_hex("A050 8x00 D007F90444 155x00");
  std::vector<rplidar::CapsuleSample> samples;
  rplidar::read_capsule(rplidar::kUltraDense, capsule, capsule, samples);
  ASSERT_EQ(samples.size(), 64U);
  EXPECT_EQ(samples[0].distance_q2, 4000U);
  EXPECT_EQ(samples[1].distance_q2, 12000U);
  EXPECT_EQ(samples[0].quality, 64);
  EXPECT_EQ(samples[1].quality, 64);
}

TEST(Golden, RplidarHq) {
  const auto decoder = decoder_of("rplidar-a3");
  const Decoded wrong = decode(*decoder, from_hex("A55A0D03004083 A5 776x00 92C940B9"));
  EXPECT_EQ(wrong.beams.size(), 0U);
  const Decoded right = decode(*decoder, from_hex("A5 776x00 B940C992"));  // 0x92C940B9, low byte first
  EXPECT_EQ(right.beams.size(), 96U);
}

TEST(Golden, RplidarAnswers) {
  const auto decoder = decoder_of("rplidar-a1");
  const Decoded got = decode(*decoder, from_hex("A55A1400000004 181D0107 16x00 A55A0300000006 020400"));
  ASSERT_EQ(got.replies.size(), 2U);
  EXPECT_EQ(got.replies[0].type, rplidar::kInfoAnswer);
  EXPECT_EQ(got.replies[0].bytes[0], 0x18);
  EXPECT_EQ(got.replies[1].bytes, (std::vector<std::uint8_t>{2, 4, 0}));
}

TEST(Golden, Hokuyo) {
  const auto decoder = decoder_of("hokuyo");
  const std::string parameters = "PP\n00P\nMODL:URG-04LX;N\n";  // its sum is wrong: the block does not count
  EXPECT_TRUE(decode(*decoder, parameters + "\n").replies.empty());
  EXPECT_EQ(decoder->counts().bad, 1U);
  // DMIN:20;4 stands in the maker's document.
  EXPECT_EQ(scip_parameter("DMIN:20"), "DMIN:20;4");
  std::vector<std::string> lines;
  for (const char* text : {"DMIN:20", "DMAX:5600", "ARES:1024", "AMIN:44", "AMAX:725", "AFRT:384", "SCAN:600"})
    lines.push_back(scip_parameter(text));
  EXPECT_EQ(decode(*decoder, scip_answer("PP", "00", lines)).replies.size(), 1U);
  EXPECT_NEAR(decoder->range_max(), 5.6, 1e-9);
  // Ranges 1000 .. 1021 mm: 0?X 0?Y .. cross the end of the first line of 64 characters.
  std::vector<WireSample> samples;
  for (int i = 0; i < 22; ++i) samples.push_back({1000.0 + i});
  const std::string block = scip_scan("MD0384040501000", "99", 1234, samples);
  EXPECT_THAT(block, ::testing::HasSubstr("\n0?X0?Y"));
  EXPECT_THAT(block, ::testing::HasSubstr("0?l0E\n?m\\\n"));
  const Decoded got = decode(*decoder, block);
  ASSERT_EQ(got.beams.size(), 22U);
  for (std::size_t i = 0; i < 22; ++i) EXPECT_NEAR(mm(got.beams[i]), 1000.0 + static_cast<double>(i), 1e-3);
  EXPECT_NEAR(got.beams[0].angle, 0.0, 1e-9);
  EXPECT_NEAR(got.beams[21].angle, 21 * kTwoPi / 1024, 1e-9);
  EXPECT_TRUE(got.beams[21].ends_turn);
}

TEST(Golden, AByteThatHokuyoLosesCostsItsLineAlone) {
  std::vector<std::string> lines;
  for (const char* text : {"DMIN:20", "DMAX:5600", "ARES:1024", "AMIN:44", "AMAX:725", "AFRT:384", "SCAN:600"})
    lines.push_back(scip_parameter(text));
  const std::string parameters = scip_answer("PP", "00", lines);
  std::vector<WireSample> samples;
  for (int i = 0; i < 100; ++i) samples.push_back({1000.0 + 7 * i});
  const std::string block = scip_scan("MD0384048301000", "99", 1234, samples);
  std::size_t data = 0;  // after echo, status and stamp
  for (int line = 0; line < 3; ++line) data = block.find('\n', data) + 1;
  for (std::size_t gone = data; gone + 2 < block.size(); ++gone) {
    const auto decoder = decoder_of("hokuyo");
    decode(*decoder, parameters);
    std::string damaged = block;
    damaged.erase(gone, 1);
    const Decoded got = decode(*decoder, damaged);
    EXPECT_GE(got.beams.size(), 100U - 44U) << gone;  // two lines hold 43 ranges at most
    for (const Beam& beam : got.beams) {
      const double step = beam.angle * 1024 / kTwoPi;
      ASSERT_NEAR(mm(beam), 1000.0 + 7 * std::round(step), 1e-2) << gone;
    }
  }
}

TEST(Golden, Sick) {
  const auto decoder = decoder_of("sick-tim");
  // A scale of 2 (40000000), from -45 deg (FFF92230) in steps of 90 deg in hundredths: ahead is 90 deg.
  const std::string text =
      "\x02sSN LMDscandata 1 1 89A27F 0 0 343 347 27477BA9 2747813B 0 0 7 0 0 5DC 168 0 1 DIST1 40000000 00000000 FFF92230 "
      "2710 3 3E8 0 7D0 0 0 0 0 0 0\x03";
  const Decoded got = decode(*decoder, text);
  ASSERT_EQ(got.beams.size(), 3U);
  EXPECT_NEAR(mm(got.beams[0]), 2000, 1e-2);
  EXPECT_EQ(got.beams[1].state, BeamState::kNoReturn);
  EXPECT_NEAR(mm(got.beams[2]), 4000, 1e-2);
  EXPECT_NEAR(rad_to_deg(got.beams[0].angle), -45 - 90, 1e-6);
  EXPECT_NEAR(rad_to_deg(got.beams[1].angle), -44 - 90, 1e-6);
  const Decoded binary = decode(*decoder, from_hex("02020202 00000011 73524E2053436465766963657374617465 30"));
  ASSERT_EQ(binary.replies.size(), 1U);
}

}  // namespace
}  // namespace phasescan::live::golden_test
