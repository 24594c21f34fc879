// A run that is saved, read back and gone on with ends as one that never stopped; bytes that are no state are refused.
#include <gtest/gtest.h>

#include "phasescan/slam/state.hpp"
#include "slam/state_types.hpp"
#include "support/state_bytes.hpp"
#include "support/toy_logs.hpp"

namespace phasescan {
namespace {

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
  std::string later = bytes;
  later[8] = 99;
  EXPECT_THROW(decode_state(later), StateError);
}

}  // namespace
}  // namespace phasescan
