#include "match/sparse_correlation.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/sparse_correlation.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Bytes add up within a byte for kGroup points, then the sums are widened.
[[maybe_unused]] constexpr std::size_t kGroup = 255 / ScoreTable::kMaxScore;
[[maybe_unused]] constexpr std::size_t kRowsAtOnce = 4;
constexpr std::size_t kSide = CorrelationWindow::kWindow;

#if HWY_TARGET == HWY_SCALAR

// Without vectors there are no halves of one: the same sums in plain loops.
void Correlate(const std::uint8_t* HWY_RESTRICT table, const std::int32_t* HWY_RESTRICT offsets, std::size_t count,
               std::uint16_t* HWY_RESTRICT sum, std::uint16_t* HWY_RESTRICT row_max) {
  for (std::size_t row = 0; row < kSide; ++row) {
    std::uint16_t* to = sum + row * kSide;
    for (std::size_t column = 0; column < kSide; ++column) to[column] = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint8_t* from = table + row * ScoreTable::kStride + offsets[k];
      for (std::size_t column = 0; column < kSide; ++column)
        to[column] = static_cast<std::uint16_t>(to[column] + from[column]);
    }
    row_max[row] = 0;
    for (std::size_t column = 0; column < kSide; ++column)
      row_max[row] = to[column] > row_max[row] ? to[column] : row_max[row];
  }
}

#else

void Correlate(const std::uint8_t* HWY_RESTRICT table, const std::int32_t* HWY_RESTRICT offsets, std::size_t count,
               std::uint16_t* HWY_RESTRICT sum, std::uint16_t* HWY_RESTRICT row_max) {
  const hn::CappedTag<std::uint8_t, kSide> d8;
  const hn::Half<decltype(d8)> d8_half;
  const hn::Rebind<std::uint16_t, decltype(d8_half)> d16;
  const std::size_t lanes = hn::Lanes(d8), half = hn::Lanes(d16);
  constexpr std::size_t kTableStride = ScoreTable::kStride;
  for (std::size_t row = 0; row < kSide; row += kRowsAtOnce) {
    for (std::size_t column = 0; column < kSide; column += lanes) {
      const std::uint8_t* corner = table + row * kTableStride + column;
      auto low0 = hn::Zero(d16), low1 = low0, low2 = low0, low3 = low0;
      auto high0 = low0, high1 = low0, high2 = low0, high3 = low0;
      for (std::size_t begin = 0; begin < count; begin += kGroup) {
        const std::size_t end = count < begin + kGroup ? count : begin + kGroup;
        auto a0 = hn::Zero(d8), a1 = a0, a2 = a0, a3 = a0;
        for (std::size_t k = begin; k < end; ++k) {
          const std::uint8_t* from = corner + offsets[k];
          a0 = hn::Add(a0, hn::LoadU(d8, from));
          a1 = hn::Add(a1, hn::LoadU(d8, from + kTableStride));
          a2 = hn::Add(a2, hn::LoadU(d8, from + 2 * kTableStride));
          a3 = hn::Add(a3, hn::LoadU(d8, from + 3 * kTableStride));
        }
        low0 = hn::Add(low0, hn::PromoteTo(d16, hn::LowerHalf(d8_half, a0)));
        low1 = hn::Add(low1, hn::PromoteTo(d16, hn::LowerHalf(d8_half, a1)));
        low2 = hn::Add(low2, hn::PromoteTo(d16, hn::LowerHalf(d8_half, a2)));
        low3 = hn::Add(low3, hn::PromoteTo(d16, hn::LowerHalf(d8_half, a3)));
        high0 = hn::Add(high0, hn::PromoteTo(d16, hn::UpperHalf(d8_half, a0)));
        high1 = hn::Add(high1, hn::PromoteTo(d16, hn::UpperHalf(d8_half, a1)));
        high2 = hn::Add(high2, hn::PromoteTo(d16, hn::UpperHalf(d8_half, a2)));
        high3 = hn::Add(high3, hn::PromoteTo(d16, hn::UpperHalf(d8_half, a3)));
      }
      std::uint16_t* to = sum + row * kSide + column;
      hn::StoreU(low0, d16, to);
      hn::StoreU(high0, d16, to + half);
      hn::StoreU(low1, d16, to + kSide);
      hn::StoreU(high1, d16, to + kSide + half);
      hn::StoreU(low2, d16, to + 2 * kSide);
      hn::StoreU(high2, d16, to + 2 * kSide + half);
      hn::StoreU(low3, d16, to + 3 * kSide);
      hn::StoreU(high3, d16, to + 3 * kSide + half);
    }
  }
  for (std::size_t row = 0; row < kSide; ++row) {
    auto best = hn::Zero(d16);
    for (std::size_t column = 0; column < kSide; column += half)
      best = hn::Max(best, hn::LoadU(d16, sum + row * kSide + column));
    alignas(64) std::uint16_t values[kSide];
    hn::StoreU(best, d16, values);
    std::uint16_t most = 0;
    for (std::size_t k = 0; k < half; ++k) most = values[k] > most ? values[k] : most;
    row_max[row] = most;
  }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

namespace phasescan {
HWY_EXPORT(Correlate);

namespace {

constexpr int kWindow = CorrelationWindow::kWindow;

CorrelationPeak peak_in_row(const CorrelationWindow& window, int row) {
  const std::uint16_t* sums = window.sum + row * kWindow;
  int column = 0;
  while (column + 1 < kWindow && sums[column] != window.row_max[row]) ++column;
  return {window.row_max[row], column, row};
}

}  // namespace

void correlate_points(const std::uint8_t* table, std::span<const std::int32_t> offsets, CorrelationWindow& out) {
  HWY_DYNAMIC_DISPATCH(Correlate)(table, offsets.data(), offsets.size(), out.sum, out.row_max);
}

CorrelationPeak highest_peak(const CorrelationWindow& window) {
  int best = 0;
  for (int r = 1; r < kWindow; ++r) {
    if (window.row_max[r] > window.row_max[best]) best = r;
  }
  return peak_in_row(window, best);
}

CorrelationPeak take_next_peak(CorrelationWindow& window, const CorrelationPeak& other, int apart) {
  const int left = std::max(other.column - apart, 0), right = std::min(other.column + apart, kWindow - 1);
  for (int r = std::max(other.row - apart, 0); r <= std::min(other.row + apart, kWindow - 1); ++r) {
    std::uint16_t* sums = window.sum + r * kWindow;
    for (int c = left; c <= right; ++c) sums[c] = 0;
    // Sums stay below 32768: signed maxima, which every x86 has in one instruction.
    std::int16_t most = 0;
    for (int c = 0; c < kWindow; ++c) most = std::max(most, static_cast<std::int16_t>(sums[c]));
    window.row_max[r] = static_cast<std::uint16_t>(most);
  }
  return highest_peak(window);
}

}  // namespace phasescan
#endif
