#include "refine/nearest_grid.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/nearest_grid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Fills `keys` with `none`. Then for each cell (given by its corner in the padded grid) and point index: the minimum of
// what is there and the key of that point, over the square of 2 reach + 1 cells (the eighth lane lies outside the reach
// and gets the largest key).
void SpreadKeys(std::size_t size, std::uint32_t none, const std::uint32_t* HWY_RESTRICT corner,
                const std::uint32_t* HWY_RESTRICT index, std::size_t count, std::size_t stride,
                const std::uint32_t* HWY_RESTRICT pattern, std::uint32_t* HWY_RESTRICT keys) {
  const hn::ScalableTag<std::uint32_t> wide;
  std::size_t filled = 0;
  for (; filled + hn::Lanes(wide) <= size; filled += hn::Lanes(wide))
    hn::StoreU(hn::Set(wide, none), wide, keys + filled);
  for (; filled < size; ++filled) keys[filled] = none;
  const hn::CappedTag<std::uint32_t, 8> d;
  constexpr std::size_t kRows = 2 * NearestGrid::kReachCells + 1;
  for (std::size_t k = 0; k < count; ++k) {
    const auto id = hn::Set(d, index[k]);
    std::uint32_t* row = keys + corner[k];
    for (std::size_t r = 0; r < kRows; ++r, row += stride) {
      for (std::size_t lane = 0; lane < 8; lane += hn::Lanes(d)) {
        const auto key = hn::Or(hn::LoadU(d, pattern + 8 * r + lane), id);
        hn::StoreU(hn::Min(hn::LoadU(d, row + lane), key), d, row + lane);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan {
HWY_EXPORT(SpreadKeys);

namespace {

constexpr int kReach = NearestGrid::kReachCells;
constexpr std::uint32_t kNone = 127U << 25;
constexpr std::size_t kRows = 2 * kReach + 1, kCellsOfAPoint = 8 * kRows;  // that SpreadKeys writes

std::array<std::uint32_t, 56> make_pattern() {
  std::array<std::uint32_t, 56> pattern{};
  for (int r = -kReach; r <= kReach; ++r) {
    for (int c = -kReach; c <= kReach + 1; ++c) {
      pattern[static_cast<std::size_t>((r + kReach) * 8 + c + kReach)] =
          c > kReach ? kNone : static_cast<std::uint32_t>(r * r + c * c) << 25;
    }
  }
  return pattern;
}

}  // namespace

void NearestGrid::build(std::span<const SurfacePoint> points, float half_width, float cell) {
  static const auto kPattern = make_pattern();
  const int inner = 2 * static_cast<int>(std::ceil(half_width / cell)) + 2;
  const int n = inner + 2 * kReach + 2;
  const auto rows = static_cast<std::size_t>(n);
  // A grid that is large for its points is not filled anew: the cells written last time are, and the rows stay as long.
  const std::size_t before = view_.stride, written = kCellsOfAPoint * occupied_;
  const bool keep =
      before >= rows && before <= 2 * rows && keys_.size() >= rows * before + 8 && 2 * written < rows * rows;
  const std::size_t stride = keep ? before : rows;
  if (keep) {
    for (std::size_t k = 0; k < occupied_; ++k) {
      for (std::size_t r = 0; r < kRows; ++r) std::fill_n(keys_.begin() + corners_[k] + r * stride, 8, kNone);
    }
  } else {
    keys_.resize(rows * rows + 8);
  }
  view_ = {nullptr, 0.5F * static_cast<float>(n) * cell, 1.0F / cell, static_cast<float>(n),
           static_cast<std::uint32_t>(stride)};
  corners_.resize(points.size());
  indices_.resize(points.size());
  std::size_t occupied = 0;
  std::uint32_t last = ~0U;
  const float low = static_cast<float>(kReach), high = static_cast<float>(n - kReach - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float u = (points[i].x + view_.offset) * view_.inverse_cell,
                v = (points[i].y + view_.offset) * view_.inverse_cell;
    if (!(u >= low && v >= low && u < high && v < high)) continue;
    const auto corner =
        (static_cast<std::uint32_t>(v) - kReach) * view_.stride + static_cast<std::uint32_t>(u) - kReach;
    if (corner == last) continue;
    last = corner;
    corners_[occupied] = corner;
    indices_[occupied++] = static_cast<std::uint32_t>(i + 1);
  }
  occupied_ = occupied;
  HWY_DYNAMIC_DISPATCH(SpreadKeys)
  (keep ? 0 : keys_.size(), kNone, corners_.data(), indices_.data(), occupied, stride, kPattern.data(), keys_.data());
}

}  // namespace phasescan
#endif
