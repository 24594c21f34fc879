#include "match/score_table.hpp"

#include <algorithm>
#include <cmath>

#include "core/fast_math.hpp"

namespace phasescan {
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
  const auto bins = static_cast<float>(bearings.size());
  for (int v = 0; v < kInner; ++v) {
    std::uint8_t* row = cells_.data() + static_cast<std::size_t>(v + kFrame) * kStride + kFrame;
    for (int u = 0; u < kInner; ++u) {
      const auto k = static_cast<std::size_t>(v * kInner + u);
      const auto bin = static_cast<std::size_t>(kPolar.turns[k] * bins);
      const float free_to = bearings.near_range[bin] * inverse_cell_ - kMarginCells;
      const float empty_to = bearings.empty_to[bin] * inverse_cell_;
      row[u] = kPolar.radius[k] < free_to ? values.free : kPolar.radius[k] < empty_to ? values.empty : values.unknown;
    }
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
