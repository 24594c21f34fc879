/// Correlation of a few dozen points with a score table over a square of translations, in integers.
#pragma once

#include <cstdint>
#include <span>

#include "match/score_table.hpp"

namespace phasescan {

/// Sums over all points for each of kWindow x kWindow translations, row = y. Every CPU gives the same sums.
struct CorrelationWindow {
  static constexpr int kWindow = 32;
  alignas(64) std::uint16_t sum[kWindow * kWindow];
  alignas(64) std::uint16_t row_max[kWindow];
};

/// One maximum: sum, and column and row in the window.
struct CorrelationPeak {
  int sum = 0;
  int column = 0;
  int row = 0;
};

/// sum[r][c] = sum over points of table[offset + r * stride + c].
/// @param offsets  of each point's window corner in the table; all (r, c) must lie inside; at most 32767 / kMaxScore
/// points
/// @source as real-time correlative matching [Olson09], but with the points few and the table so small that it stays in
/// L1
void correlate_points(const std::uint8_t* table, std::span<const std::int32_t> offsets, CorrelationWindow& out);

/// The largest sum (first in row order among equals).
CorrelationPeak highest_peak(const CorrelationWindow& window);

/// The largest sum more than `apart` cells away from `other` in row or column; sums nearer than that become 0.
CorrelationPeak take_next_peak(CorrelationWindow& window, const CorrelationPeak& other, int apart);

}  // namespace phasescan
