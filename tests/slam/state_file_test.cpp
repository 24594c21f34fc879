// A run that is saved, read back and gone on with ends as one that never stopped; bytes that are no state are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "phasescan/slam/state.hpp"
#include "slam/state_types.hpp"
#include "state/container.hpp"
#include "support/paths.hpp"
#include "support/sealed_state.hpp"
#include "support/state_bytes.hpp"
#include "support/toy_logs.hpp"

namespace phasescan::state_file_test {
namespace {

using ::testing::HasSubstr;
using testing::to_bytes;

std::string end_of(Slam& slam) {
  const SlamResult result = slam.finish();
  StateWriter out;
  for (const ScanResult& scan : result.scans) out.write(scan.T_map_base), out.write(scan.T_odom_base);
  out.write(result.edges);
  for (const CellState cell : result.map.cells) out.write(static_cast<std::uint8_t>(cell));
  return out.bytes;
}

TEST(StateFile, GoesOnWithTheSameBytes) {
  for (const bool bounded : {false, true}) {
    SlamOptions options;
    options.slam.bounded_memory = bounded;
    for (const testing::ToyLog& log : testing::toy_logs(150)) {
      Slam whole(options);
      for (const RangeMeasurement& m : log.measurements) whole.add(m);
      const std::string end = end_of(whole);
      for (const std::size_t stop : {1u, 2u, 37u, 91u, 120u}) {
        if (stop >= log.measurements.size()) continue;
        Slam first(options);
        for (std::size_t i = 0; i < stop; ++i) first.add(log.measurements[i]);
        const SavedRun saved = decode_state(encode_state({first.checkpoint(), options}));
        Slam second(saved.state, saved.options);
        for (std::size_t i = stop; i < log.measurements.size(); ++i) second.add(log.measurements[i]);
        EXPECT_TRUE(end_of(second) == end) << log.name << " stopped after " << stop << ", bounded " << bounded;
      }
    }
  }
}

TEST(StateFile, WhatIsCutOffFlippedOrForeignIsRefused) {
  const testing::ToyLog log = testing::turning_lidar_log(60);
  Slam slam;
  for (const RangeMeasurement& m : log.measurements) slam.add(m);
  const std::string bytes = encode_state({slam.checkpoint(), {}});
  for (std::size_t n = 0; n < bytes.size(); n += 1000)
    EXPECT_THROW(decode_state(std::string_view(bytes).substr(0, n)), StateError) << n;
  for (std::size_t at = 0; at < bytes.size(); at += 997) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    EXPECT_THROW(decode_state(flipped), StateError) << at;
  }
  EXPECT_THROW(decode_state("FLASER 180 1 2 3"), StateError);
  EXPECT_THROW(decode_state(bytes + "x"), StateError);
}

/// What a reader says of bytes; empty where it takes them.
std::string refusal_of(const std::string& bytes) {
  try {
    decode_state(bytes);
    return {};
  } catch (const StateError& error) {
    return error.what();
  }
}

TEST(StateFile, AFileOfALaterBuildIsRefusedByItsVersion) {
  const testing::ToyLog log = testing::turning_lidar_log(20);
  Slam slam;
  for (const RangeMeasurement& m : log.measurements) slam.add(m);
  std::string later = encode_state({slam.checkpoint(), {}});
  testing::put_state_number(later, 8, 4, kStateFileVersion + 1);
  EXPECT_THAT(refusal_of(testing::sealed(later)),
              HasSubstr("version " + std::to_string(kStateFileVersion + 1) + "; this build reads versions 1 to " +
                        std::to_string(kStateFileVersion)));
}

TEST(StateFile, WhatIsChangedPastTheChecksumsIsRefusedOrGoneOnWith) {
  const testing::ToyLog log = testing::two_lasers_log(40);
  for (const bool bounded : {false, true}) {
    SlamOptions options;
    options.slam.bounded_memory = bounded;
    Slam slam(options);
    for (std::size_t i = 0; i < 30; ++i) slam.add(log.measurements[i]);
    slam.begin_session();
    for (std::size_t i = 30; i < 40; ++i) slam.add(log.measurements[i]);
    const std::string bytes = testing::unpacked_file(encode_state({slam.checkpoint(), options}));
    ASSERT_EQ(refusal_of(bytes), "");
    std::size_t refused = 0, taken = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 1009) {
      for (const char change : {'\x01', '\x80', '\xFF'}) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ change);
        flipped = testing::sealed(flipped);
        const std::string why = refusal_of(flipped);
        ++(why.empty() ? taken : refused);
        EXPECT_EQ(why.find('\n'), std::string::npos);
        if (!why.empty() || taken % 10 != 0) continue;
        Slam resumed(decode_state(flipped).state, options);
        for (std::size_t i = 40; i < 44; ++i) resumed.add(log.measurements[i % log.measurements.size()]);
        EXPECT_EQ(resumed.scans(), 44u);
      }
    }
    EXPECT_GT(refused, 20u);
    EXPECT_GT(taken, 20u);
  }
}

TEST(StateFile, OptionsOfAnotherBuildAreReadByName) {
  const testing::ToyLog log = testing::turning_lidar_log(20);
  SlamOptions options;
  options.odometry.cell_m = 0.2;
  Slam slam(options);
  for (const RangeMeasurement& m : log.measurements) slam.add(m);
  StateSections file = unpack_state(encode_state({slam.checkpoint(), options}));
  StateSection& section = *std::find_if(file.sections.begin(), file.sections.end(),
                                        [](const StateSection& s) { return s.name == "options"; });
  const std::string all = section.content;
  // One that this build does not know, and one that the other did not have.
  section.content = "slam.from_another_build=7\n" + all;
  const std::string gone = "slam.batch_nodes=10\n";
  section.content.erase(section.content.find(gone), gone.size());
  const SavedRun read = decode_state(pack_state(file));
  EXPECT_EQ(read.options.odometry.cell_m, 0.2);
  EXPECT_EQ(read.options.slam.batch_nodes, 10);
  section.content = all;
  section.content.replace(section.content.find(gone), gone.size(), "slam.batch_nodes=many\n");
  EXPECT_THAT(refusal_of(pack_state(file)), HasSubstr("slam.batch_nodes"));
  section.content = "no options";
  EXPECT_THAT(refusal_of(pack_state(file)), HasSubstr("its options are no options"));
}

// A file of each version is kept from the first one on. This one: two drives through a room, 24 scans with wheels and
// 14 without, `slam --beam-step 4`.
TEST(StateFile, AFileOfTheFirstVersionIsRead) {
  const SavedRun run = read_state(test::source_dir() + "/tests/data/state-v1.state");
  EXPECT_EQ(run.version, 1u);
  EXPECT_LT(run.version, kStateFileVersion);
  const StateSummary summary = summarize(run.state);
  EXPECT_EQ(summary.scans, 38u);
  EXPECT_EQ(summary.drives, 2);
  EXPECT_EQ(summary.keyframes, 13u);
  EXPECT_EQ(run.state.data().frame_session, 0);       // came with version 2
  EXPECT_EQ(run.state.data().ledger.wheels_off, -1);  // with version 3
  Slam slam(run.state, run.options);
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), 38u);
  ASSERT_EQ(result.parts.size(), 2u);
  EXPECT_EQ(result.wheels.steps, 23u);
  // Written again it is of this version, and the same run.
  const SavedRun again = decode_state(encode_state(run));
  EXPECT_EQ(again.version, kStateFileVersion);
  EXPECT_TRUE(to_bytes(again.state.data()) == to_bytes(run.state.data()));
}

// Two drives through a flat, 33 scans with wheels and 33 without, `slam --beam-step 4`.
TEST(StateFile, AFileOfTheThirdVersionIsRead) {
  const SavedRun run = read_state(test::source_dir() + "/tests/data/state-v3.state");
  EXPECT_EQ(run.version, 3u);
  EXPECT_EQ(summarize(run.state).scans, 66u);
  EXPECT_EQ(summarize(run.state).drives, 2);
  const SlamResult result = Slam(run.state, run.options).finish();
  ASSERT_EQ(result.scans.size(), 66u);
  EXPECT_EQ(result.wheels.steps, 32u);
  EXPECT_EQ(result.wheels.wheels_m, 0.0);  // came with version 4
}

// Two drives through a room, 27 scans with wheels and 16 without, `slam --beam-step 4`.
TEST(StateFile, AFileOfTheSecondVersionIsRead) {
  const SavedRun run = read_state(test::source_dir() + "/tests/data/state-v2.state");
  EXPECT_EQ(run.version, 2u);
  EXPECT_EQ(summarize(run.state).scans, 43u);
  EXPECT_EQ(summarize(run.state).drives, 2);
  EXPECT_EQ(run.state.data().ledger.wheels_off, -1);  // came with version 3
  const SlamResult result = Slam(run.state, run.options).finish();
  ASSERT_EQ(result.scans.size(), 43u);
  EXPECT_EQ(result.wheels.steps, 26u);
  const SavedRun again = decode_state(encode_state(run));
  EXPECT_EQ(again.version, kStateFileVersion);
  EXPECT_TRUE(to_bytes(again.state.data()) == to_bytes(run.state.data()));
}

struct Grown {
  int old_field = 0, new_field = 7;
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("old_field", self.old_field);
    visit_since(v, 3, "new_field", self.new_field);
  }
};

TEST(StateFile, AFieldThatCameLaterKeepsItsDefaultInFilesFromBefore) {
  StateWriter old;
  old.write(5);
  Grown read;
  StateReader before(old.bytes, 2);
  before.read(read);
  EXPECT_TRUE(before.at_end());
  EXPECT_EQ(read.old_field, 5);
  EXPECT_EQ(read.new_field, 7);
  const std::string both = to_bytes(Grown{1, 2});
  StateReader now(both, 3);
  now.read(read);
  EXPECT_TRUE(now.at_end());
  EXPECT_EQ(read.new_field, 2);
  EXPECT_THROW(StateReader(old.bytes, 3).read(read), StateFormatError);
}

}  // namespace
}  // namespace phasescan::state_file_test
