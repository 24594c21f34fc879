#include "match/score_table.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/score_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace phasescan {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Scores of a row of inner cells: `inside` where the cell is nearer than its bearing's limit, `unknown` elsewhere; a
// limit's sign tells free space (plus) from emptiness (minus).
void ScoreRow(const float* HWY_RESTRICT radius, const float* HWY_RESTRICT limit, const ScoreTableValues& values,
              std::uint8_t* HWY_RESTRICT row) {
  const hn::CappedTag<float, ScoreTable::kCells> df;
  const hn::RebindToSigned<decltype(df)> di;
  const hn::Rebind<std::uint8_t, decltype(df)> d8;
  const auto free = hn::Set(di, values.free), empty = hn::Set(di, values.empty), unknown = hn::Set(di, values.unknown);
  for (std::size_t k = 0; k < ScoreTable::kCells; k += hn::Lanes(df)) {
    const auto to = hn::LoadU(df, limit + k);
    const auto nearer = hn::RebindMask(di, hn::Lt(hn::LoadU(df, radius + k), hn::Abs(to)));
    const auto seen_empty = hn::RebindMask(di, hn::Lt(to, hn::Zero(df)));
    const auto score = hn::IfThenElse(nearer, hn::IfThenElse(seen_empty, empty, free), unknown);
    hn::StoreU(hn::DemoteTo(d8, score), d8, row + k);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace phasescan
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cmath>

#include "core/fast_math.hpp"

namespace phasescan {
HWY_EXPORT(ScoreRow);

namespace {

constexpr int kInner = ScoreTable::kCells;

// Direction and distance of every inner cell's centre, in turns and cells: the same for every scan.
struct PolarCells {
  std::array<float, kInner * kInner> turns{}, radius{};
  PolarCells() {
    for (int v = 0; v < kInner; ++v) {
      for (int u = 0; u < kInner; ++u) {
        const float x = static_cast<float>(u - kInner / 2) + 0.5F, y = static_cast<float>(v - kInner / 2) + 0.5F;
        const auto k = static_cast<std::size_t>(v * kInner + u);
        turns[k] = direction_turns(x, y);
        radius[k] = std::sqrt(x * x + y * y);
      }
    }
  }
};

}  // namespace

void ScoreTable::build(const SurfacePoints& surface, const BearingTable& bearings, double half_width_m,
                       const ScoreTableValues& values) {
  static const PolarCells kPolar;
  values_ = values;
  cell_ = static_cast<float>(2.0 * half_width_m / kCells);
  inverse_cell_ = 1.0F / cell_;
  cells_.assign(std::size_t{kStride} * kStride + 64, values.unknown);

  // Free space ends this much before the surface: a point that falls short by less may be noise or a coarse rotation.
  constexpr float kMarginCells = 2.0F;
  if (bins_ != bearings.size()) {
    bins_ = bearings.size();
    bin_of_cell_.resize(kPolar.turns.size());
    for (std::size_t k = 0; k < bin_of_cell_.size(); ++k)
      bin_of_cell_[k] = static_cast<std::uint16_t>(kPolar.turns[k] * static_cast<float>(bins_));
  }
  limit_.resize(bins_);
  for (std::size_t bin = 0; bin < bins_; ++bin) {
    // A bearing has either hits or emptiness.
    const float free_to = bearings.near_range[bin] * inverse_cell_ - kMarginCells;
    const float empty_to = bearings.empty_to[bin] * inverse_cell_;
    limit_[bin] = bearings.near_range[bin] > 0.0F ? std::max(free_to, 0.0F) : -empty_to;
  }
  for (int v = 0; v < kInner; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * kInner;
    float limits[kInner];
    for (std::size_t u = 0; u < kInner; ++u) limits[u] = limit_[bin_of_cell_[first + u]];
    HWY_DYNAMIC_DISPATCH(ScoreRow)
    (kPolar.radius.data() + first, limits, values,
     cells_.data() + static_cast<std::size_t>(v + kFrame) * kStride + kFrame);
  }
  constexpr float kLow = kFrame, kHigh = kFrame + kInner;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const float u = position(surface[i].x), v = position(surface[i].y);
    if (!(u >= kLow && v >= kLow && u < kHigh && v < kHigh)) continue;
    std::uint8_t* centre = cells_.data() + static_cast<std::size_t>(v) * kStride + static_cast<std::size_t>(u);
    if (*centre == values.surface) continue;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        std::uint8_t& cell = centre[dv * kStride + du];
        cell = std::max(cell, values.beside);
      }
    }
    *centre = values.surface;
  }
}

}  // namespace phasescan
#endif
