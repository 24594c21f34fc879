/// Fixed inputs through the SIMD kernels, for the comparison between CPU targets.
#pragma once

#include <cstdint>
#include <vector>

#include "match/score_table.hpp"
#include "phasescan/match/scan_matcher.hpp"
#include "match/sparse_correlation.hpp"
#include "support/rooms.hpp"

namespace phasescan::test {

/// What integer kernels say: the same on every CPU, bit for bit.
inline std::vector<std::uint32_t> integer_answers() {
  std::vector<std::uint32_t> out;
  Random random(5);
  std::vector<std::uint8_t> table(std::size_t{ScoreTable::kStride} * ScoreTable::kStride + 64);
  for (auto& value : table) value = static_cast<std::uint8_t>(random.below(ScoreTable::kMaxScore + 1));
  CorrelationWindow window;
  for (const std::size_t points : {0, 1, 3, 37, 64, 500}) {
    std::vector<std::int32_t> offsets;
    for (std::size_t k = 0; k < points; ++k) {
      constexpr int kRoom = ScoreTable::kStride - CorrelationWindow::kWindow;
      offsets.push_back(static_cast<std::int32_t>(random.below(kRoom)) * ScoreTable::kStride +
                        static_cast<std::int32_t>(random.below(kRoom)));
    }
    correlate_points(table.data(), offsets, window);
    out.insert(out.end(), std::begin(window.sum), std::end(window.sum));
    out.insert(out.end(), std::begin(window.row_max), std::end(window.row_max));
    const CorrelationPeak best = highest_peak(window), next = take_next_peak(window, best, 3);
    for (const int value : {best.sum, best.column, best.row, next.sum, next.column, next.row})
      out.push_back(static_cast<std::uint32_t>(value));
  }
  return out;
}

/// Poses of the default matcher, which come through all kernels.
inline std::vector<MatchResult> match_answers() {
  std::vector<MatchResult> out;
  ScanMatcher matcher;
  Random random(6);
  for (std::uint64_t k = 0; k < 60; ++k) {
    const Pose2 truth{random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9), random.uniform(-kPi, kPi)};
    const int beams = k % 3 == 0 ? 200 : k % 3 == 1 ? 360 : 1000;
    out.push_back(matcher.match(cast_room({}, beams, 0.01, 0.02, 2 * k + 1),
                                cast_room(truth, beams, 0.01, 0.02, 2 * k + 2, 6.0, -kPi, k % 2 == 0)));
  }
  return out;
}

}  // namespace phasescan::test
