// Laws of all decoders: pieces of any size, wrong bits, lost bytes and rubbish between packets.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <tuple>

#include "live/streams.hpp"
#include "phasescan/live/turns.hpp"

namespace phasescan::live::stream_test {
namespace {

using namespace testing;

/// The forms of which something holds.
std::vector<Form> forms_that(const std::function<bool(const Form&)>& holds) {
  std::vector<Form> all = forms();
  std::erase_if(all, [&](const Form& form) { return !holds(form); });
  return all;
}
/// A lost packet shows in those after it: a packet is no whole turn, and says where the ones before it were.
bool tells_of_lost(const Form& form) {
  return !is_text(form) && form.rplidar_type != rplidar::kNodes && form.rplidar_type != rplidar::kHqNodes;
}
std::string name_of_param(const ::testing::TestParamInfo<Form>& form) {
  return name_of(form.param);
}

class Streams : public ::testing::TestWithParam<Form> {};
class CheckedStreams : public Streams {};
class UncheckedStreams : public Streams {};
class StreamsOfPackets : public Streams {};
INSTANTIATE_TEST_SUITE_P(All, Streams, ::testing::ValuesIn(forms()), name_of_param);
INSTANTIATE_TEST_SUITE_P(All, CheckedStreams, ::testing::ValuesIn(forms_that([](const Form& f) { return f.checked; })),
                         name_of_param);
INSTANTIATE_TEST_SUITE_P(All, UncheckedStreams,
                         ::testing::ValuesIn(forms_that([](const Form& f) { return !f.checked; })), name_of_param);
INSTANTIATE_TEST_SUITE_P(All, StreamsOfPackets, ::testing::ValuesIn(forms_that(tells_of_lost)), name_of_param);

const std::vector<Form> kAll = forms();
constexpr Stamp kStart = 1'000'000'000'000;

/// Feeds packets as they come over the line: each arrives when its last sample was taken and its bytes were sent.
Decoded feed(Decoder& decoder, const Form& form, const std::vector<WirePacket>& packets) {
  const double rate = bytes_per_second(*find_sensor(form.sensor));
  Decoded out;
  decoder.feed(opening(form), kStart, out);
  for (const WirePacket& packet : packets) {
    const double wire_s = rate > 0.0 ? static_cast<double>(packet.bytes.size()) / rate : 0.0;
    decoder.feed(packet.bytes, kStart + stamp_from_seconds(packet.time_s + wire_s), out);
  }
  return out;
}

std::vector<std::uint8_t> joined(const Form& form, const std::vector<WirePacket>& packets) {
  std::vector<std::uint8_t> bytes = opening(form);
  for (const WirePacket& packet : packets) bytes.insert(bytes.end(), packet.bytes.begin(), packet.bytes.end());
  return bytes;
}

/// Direction and range of a beam, as coarse as arithmetic in another order may differ.
using Seen = std::tuple<long, long>;
Seen seen(const Beam& beam) {
  return {std::lround(1e6 * wrap_positive(beam.angle + 1e-9)), std::lround(1e6 * beam.range_m)};
}
std::set<Seen> all_seen(const Decoded& decoded) {
  std::set<Seen> all;
  for (const Beam& beam : decoded.beams) all.insert(seen(beam));
  return all;
}

TEST_P(Streams, AScanATurnWithItsTimes) {
  const Form form = GetParam();
  const double rate = samples_hz(form);
  const auto decoder = decoder_of(form.sensor);
  const Decoded got = feed(*decoder, form, packets_of(form, 4));
  EXPECT_EQ(decoder->counts().bad, 0U);
  TurnAssembler turns;
  std::vector<Scan> scans;
  turns.add(got.beams, decoder->range_min(), decoder->range_max(), scans);
  ASSERT_GE(scans.size(), 2U);
  EXPECT_EQ(turns.counts().lost_beams, 0U);
  for (const Scan& scan : scans) {
    EXPECT_EQ(scan.size(), static_cast<std::size_t>(form.samples_per_turn));
    EXPECT_EQ(scan.hit_count(), scan.size());
    EXPECT_NEAR(scan.time_increment, 1.0 / rate, 0.02 / rate);
  }
  // Scans follow each other by a turn, and the first sample of a turn was taken when it was.
  const double turn_s = form.samples_per_turn / rate;
  for (std::size_t k = 1; k < scans.size(); ++k)
    EXPECT_NEAR(stamp_to_seconds(scans[k].stamp - scans[k - 1].stamp), turn_s, 0.01 * turn_s);
  const double first = stamp_to_seconds(scans[1].stamp - kStart) / turn_s;
  if (!is_text(form)) {
    EXPECT_NEAR(first, std::round(first), 0.02);
  }
}

TEST_P(Streams, PiecesOfAnySizeAreTheSame) {
  const Form form = GetParam();
  const auto bytes = joined(form, packets_of(form, 2));
  const auto whole = decoder_of(form.sensor), pieces = decoder_of(form.sensor);
  const Decoded expected = decode(*whole, bytes);
  Decoded got;
  std::mt19937 random(5);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(1 + random() % 90, bytes.size() - at);
    pieces->feed(std::span(bytes).subspan(at, size), kStart, got);
    at += size;
  }
  ASSERT_EQ(got.beams.size(), expected.beams.size());
  EXPECT_EQ(pieces->counts().packets, whole->counts().packets);
  for (std::size_t i = 0; i < got.beams.size(); ++i) EXPECT_EQ(seen(got.beams[i]), seen(expected.beams[i]));
}

TEST_P(CheckedStreams, NoBeamOfAPacketWithAWrongBit) {
  const Form form = GetParam();
  const auto packets = packets_of(form, 3);
  const auto right = joined(form, packets);
  const auto clean = decoder_of(form.sensor);
  const std::set<Seen> expected = all_seen(decode(*clean, right));
  const std::size_t from = opening(form).size();
  std::mt19937 random(11);
  for (int trial = 0; trial < 400; ++trial) {
    auto bytes = right;
    bytes[from + random() % (bytes.size() - from)] ^= static_cast<std::uint8_t>(1U << random() % 8);
    const auto decoder = decoder_of(form.sensor);
    const Decoded got = decode(*decoder, bytes);
    // SCIP's echo has no sum; what it says of the steps must fit the ranges.
    if (!is_text(form)) {
      EXPECT_LT(decoder->counts().packets, clean->counts().packets);
    }
    for (const Beam& beam : got.beams) ASSERT_TRUE(expected.contains(seen(beam))) << trial;
    EXPECT_FALSE(got.beams.empty());
  }
}

TEST_P(UncheckedStreams, AWrongBitIsAWrongBeamAtMost) {
  const Form form = GetParam();
  const auto packets = packets_of(form, 4);
  const auto right = joined(form, packets);
  const auto clean = decoder_of(form.sensor);
  const std::set<Seen> expected = all_seen(decode(*clean, right));
  // What a sensor usually sends is known from its first telegram on.
  const std::size_t from = opening(form).size() + packets.front().bytes.size();
  std::mt19937 random(17);
  std::size_t wrong = 0;
  constexpr std::size_t kTrials = 400;
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    auto bytes = right;
    bytes[from + random() % (bytes.size() - from)] ^= static_cast<std::uint8_t>(1U << random() % 8);
    const auto decoder = decoder_of(form.sensor);
    for (const Beam& beam : decode(*decoder, bytes).beams)
      wrong += beam.state == BeamState::kHit && !expected.contains(seen(beam));
  }
  EXPECT_LE(wrong, kTrials);  // one byte was hit in each
}

TEST(Scip, AWrongLineCostsItsRangesAlone) {
  const Form& form = *std::find_if(std::begin(kAll), std::end(kAll),
                                   [](const Form& f) { return f.sensor == std::string_view("hokuyo"); });
  const auto packets = packets_of(form, 3);
  const auto clean = decoder_of(form.sensor);
  const std::set<Seen> expected = all_seen(feed(*clean, form, packets));
  auto damaged = packets;
  for (WirePacket& packet : damaged) packet.bytes[packet.bytes.size() / 2] ^= 1;
  const auto decoder = decoder_of(form.sensor);
  const Decoded got = feed(*decoder, form, damaged);
  for (const Beam& beam : got.beams) EXPECT_TRUE(expected.contains(seen(beam)));
  TurnAssembler turns;
  std::vector<Scan> scans;
  turns.add(got.beams, decoder->range_min(), decoder->range_max(), scans);
  ASSERT_GE(scans.size(), 2U);
  for (const Scan& scan : scans) {
    EXPECT_EQ(scan.size(), static_cast<std::size_t>(form.samples_per_turn));
    // 64 characters touch 22 or 23 ranges of 3.
    EXPECT_GE(scan.hit_count(), scan.size() - 23);
    EXPECT_LE(scan.hit_count(), scan.size() - 21);
  }
}

/// The telegram of a SICK has no check.
struct SickTelegrams {
  Form form = *std::find_if(std::begin(kAll), std::end(kAll),
                            [](const Form& f) { return f.sensor == std::string_view("sick-tim"); });
  std::vector<WirePacket> packets = packets_of(form, 8);
  /// Exchanges a byte of a word of telegram `n`.
  void spoil(std::size_t n, std::size_t word, std::uint8_t with) {
    ByteString& bytes = packets[n].bytes;
    std::size_t at = 0;
    for (std::size_t k = 0; k < word; ++k)
      at = static_cast<std::size_t>(std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), ' ') -
                                    bytes.begin()) +
           1;
    bytes.at(at) = with;
  }
  std::vector<Scan> scans() const {
    const auto decoder = decoder_of(form.sensor);
    TurnAssembler turns;
    std::vector<Scan> out;
    turns.add(feed(*decoder, form, packets).beams, decoder->range_min(), decoder->range_max(), out);
    return out;
  }
};

TEST(Sick, AWrongTimeOfItsClockMovesNoScan) {
  constexpr std::size_t kStarted = 9, kFrequency = 16;
  const std::vector<Scan> right = SickTelegrams().scans();
  ASSERT_EQ(right.size(), 8U);
  for (const std::size_t word : {kStarted, kFrequency}) {
    SickTelegrams telegrams;
    telegrams.spoil(4, word, word == kStarted ? '3' : 'E');  // earlier than the last one, faster
    const std::vector<Scan> spoilt = telegrams.scans();
    ASSERT_EQ(spoilt.size(), right.size());
    for (std::size_t i = 0; i < right.size(); ++i) {
      EXPECT_NEAR(stamp_to_seconds(spoilt[i].stamp - right[i].stamp), 0.0, 1e-3) << word << " " << i;
      EXPECT_NEAR(spoilt[i].time_increment, right[i].time_increment, 1e-7) << word << " " << i;
    }
  }
}

TEST(Sick, AValueThatIsNoNumberCostsItsBeamAlone) {
  constexpr std::size_t kFirstValue = 26;
  SickTelegrams telegrams;
  telegrams.spoil(3, kFirstValue + 100, '!');
  const std::vector<Scan> right = SickTelegrams().scans(), spoilt = telegrams.scans();
  ASSERT_EQ(spoilt.size(), right.size());
  std::size_t invalid = 0;
  for (std::size_t i = 0; i < right[3].size(); ++i) {
    invalid += spoilt[3].states[i] == BeamState::kInvalid;
    if (spoilt[3].states[i] == BeamState::kInvalid) continue;
    EXPECT_EQ(spoilt[3].ranges[i], right[3].ranges[i]);
  }
  EXPECT_EQ(invalid, 1U);
}

TEST_P(Streams, LostBytesCostTheirPacketsAlone) {
  const Form form = GetParam();
  const auto packets = packets_of(form, 3);
  const auto right = joined(form, packets);
  const auto clean = decoder_of(form.sensor);
  const Decoded whole = decode(*clean, right);
  const std::set<Seen> expected = all_seen(whole);
  const std::size_t from = opening(form).size();
  std::mt19937 random(13);
  for (int trial = 0; trial < 200; ++trial) {
    auto bytes = right;
    const auto at = static_cast<std::ptrdiff_t>(from + random() % (bytes.size() - from - 8));
    if (trial % 2 == 0) {
      bytes.erase(bytes.begin() + at, bytes.begin() + at + 1 + static_cast<std::ptrdiff_t>(random() % 5));
    } else {
      const std::vector<std::uint8_t> rubbish = {0xAA, 0x55, 0xFA, 0xA0, 0x54, 0x2C, 0xA5};
      bytes.insert(bytes.begin() + at, rubbish.begin(),
                   rubbish.begin() + 1 + static_cast<std::ptrdiff_t>(random() % 7));
    }
    const auto decoder = decoder_of(form.sensor);
    const Decoded got = decode(*decoder, bytes);
    std::size_t wrong = 0;
    for (const Beam& beam : got.beams) wrong += !expected.contains(seen(beam));
    if (form.checked) {
      EXPECT_EQ(wrong, 0U) << trial;
    } else if (!is_text(form)) {
      EXPECT_LE(wrong, 1U) << trial;
    }
    // A capsule needs its neighbour, a turn sent as a whole goes as a whole.
    EXPECT_GE(decoder->counts().packets + 9, clean->counts().packets) << trial;
    EXPECT_FALSE(got.beams.empty());
  }
}

TEST_P(StreamsOfPackets, LostOnesLeaveTheirBeamsWithoutRange) {
  const Form form = GetParam();
  auto packets = packets_of(form, 5);
  const std::size_t a_turn = packets.size() / 5;
  packets.erase(packets.begin() + static_cast<std::ptrdiff_t>(2 * a_turn + a_turn / 2));
  const auto decoder = decoder_of(form.sensor);
  const Decoded got = feed(*decoder, form, packets);
  TurnAssembler turns;
  std::vector<Scan> scans;
  turns.add(got.beams, decoder->range_min(), decoder->range_max(), scans);
  ASSERT_GE(scans.size(), 2U);
  EXPECT_GT(turns.counts().lost_beams, 0U);
  bool found = false;
  for (const Scan& scan : scans) {
    EXPECT_NEAR(static_cast<double>(scan.size()), form.samples_per_turn, 1.0);
    EXPECT_NEAR(scan.time_increment, 1.0 / samples_hz(form), 0.02 / samples_hz(form));
    for (std::size_t i = 0; i < scan.size(); ++i) found |= scan.states[i] == BeamState::kInvalid;
  }
  EXPECT_TRUE(found);
}

TEST_P(Streams, RubbishIsBounded) {
  const auto decoder = decoder_of(GetParam().sensor);
  Decoded out;
  decoder->feed(opening(GetParam()), kStart, out);
  std::mt19937 random(17);
  std::vector<std::uint8_t> bytes(200'000);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  decoder->feed(bytes, kStart, out);
  const StreamCounts counts = decoder->counts();
  EXPECT_GE(counts.bytes, bytes.size());
  if (GetParam().checked) {
    EXPECT_LT(out.beams.size(), 200U);
  }
  decoder->feed(std::vector<std::uint8_t>(200'000, 'A'), kStart, out);
  decoder->feed(std::vector<std::uint8_t>(200'000, 0x02), kStart, out);
}

}  // namespace
}  // namespace phasescan::live::stream_test
