#include "match/sparse_correlation.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.hpp"

namespace phasescan::sparse_correlation_test {
namespace {

constexpr int kWindow = CorrelationWindow::kWindow;

struct Case {
  std::vector<std::uint8_t> table;
  std::vector<std::int32_t> offsets;
};

Case random_case(std::uint64_t seed, int points) {
  Random random(seed);
  Case c;
  c.table.resize(std::size_t{ScoreTable::kStride} * ScoreTable::kStride + 64);
  for (auto& cell : c.table) cell = static_cast<std::uint8_t>(random.below(ScoreTable::kMaxScore + 1));
  const auto most = static_cast<std::uint64_t>(ScoreTable::kStride - kWindow);
  for (int k = 0; k < points; ++k) {
    c.offsets.push_back(static_cast<std::int32_t>(random.below(most) * ScoreTable::kStride + random.below(most)));
  }
  return c;
}

TEST(SparseCorrelation, GivesTheSumsOfAPlainLoop) {
  for (const int points : {0, 1, 30, 31, 32, 64, 200, 1000}) {
    const Case c = random_case(static_cast<std::uint64_t>(points) + 7, points);
    CorrelationWindow window;
    correlate_points(c.table.data(), c.offsets, window);
    for (int r = 0; r < kWindow; ++r) {
      int row_max = 0;
      for (int u = 0; u < kWindow; ++u) {
        int sum = 0;
        for (const std::int32_t offset : c.offsets)
          sum += c.table[static_cast<std::size_t>(offset + r * ScoreTable::kStride + u)];
        ASSERT_EQ(window.sum[r * kWindow + u], sum) << points << " points, row " << r << ", column " << u;
        row_max = std::max(row_max, sum);
      }
      ASSERT_EQ(window.row_max[r], row_max);
    }
  }
}

TEST(SparseCorrelation, PeaksAreTheLargestSumsAndApart) {
  const Case c = random_case(3, 64);
  CorrelationWindow window;
  correlate_points(c.table.data(), c.offsets, window);
  const CorrelationPeak first = highest_peak(window);
  int best = -1, next = -1;
  for (int r = 0; r < kWindow; ++r) {
    for (int u = 0; u < kWindow; ++u) {
      const int sum = window.sum[r * kWindow + u];
      best = std::max(best, sum);
      if (std::abs(r - first.row) > 3 || std::abs(u - first.column) > 3) next = std::max(next, sum);
    }
  }
  EXPECT_EQ(first.sum, best);
  EXPECT_EQ(window.sum[first.row * kWindow + first.column], best);
  const CorrelationPeak second = take_next_peak(window, first, 3);
  EXPECT_EQ(second.sum, next);
  EXPECT_EQ(window.sum[second.row * kWindow + second.column], next);
}

}  // namespace
}  // namespace phasescan::sparse_correlation_test
