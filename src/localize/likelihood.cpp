#include "localize/likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace phasescan {
namespace {

constexpr float kOutlier = 0.05F;         // share of hits that are on nothing the map has
constexpr float kThroughLog = -4.6F;      // a ray through a surface of the map: one in a hundred
constexpr float kWithinCells = 0.6F;      // standard deviation of a surface within the cells that show it
constexpr float kBeforeHitM = 0.3F;       // a surface counts as passed where it lies so much nearer than the hit
constexpr float kSigmasExplained = 2.5F;  // of a hit that lies on the map
constexpr float kAsideCells = 1.5F;       // of the rays beside one
constexpr float kUnknownM = 0.5F;  // from a surface, a hit is where the map knows nothing; nearer it is off a wall
constexpr float kBeginM = 0.1F;    // rays begin so far from the laser: it may stand in a drawn cell

}  // namespace

float map_variance(const MapGrid& grid) {
  const float sigma = kWithinCells * grid.cell_m;
  return sigma * sigma;
}

namespace {

/// Whether a ray went through a surface of the map: rays a little to either side are stopped as well. Else it passed an
/// edge, a speck or a wall that it runs along, where cells are not exact.
bool goes_through(const MapGrid& grid, float x, float y, float dx, float dy, float most) {
  if (grid.cast(x, y, dx, dy, most) >= most) return false;
  const float aside = kAsideCells * grid.cell_m;
  return grid.cast(x - aside * dy, y + aside * dx, dx, dy, most) < most &&
         grid.cast(x + aside * dy, y - aside * dx, dx, dy, most) < most;
}

/// Over squared distances in variances, in steps of 1/8.
struct HitTable {
  static constexpr float kSteps = 8.0F;
  static constexpr std::size_t kSize = 256;
  std::array<float, kSize + 1> log_likelihood;
  HitTable() : log_likelihood() {
    for (std::size_t i = 0; i <= kSize; ++i) {
      const float off = static_cast<float>(i) / kSteps;
      log_likelihood[i] = std::log((1.0F - kOutlier) * std::exp(-0.5F * off) + kOutlier);
    }
  }
};

const HitTable& hit_table() {
  static const HitTable table;
  return table;
}

float look_up(const HitTable& table, float distance_m, float variance) {
  const float at =
      std::min(distance_m * distance_m / variance * HitTable::kSteps, static_cast<float>(HitTable::kSize) - 1.0F);
  const auto i = static_cast<std::size_t>(at);
  const float share = at - static_cast<float>(i);
  return (1.0F - share) * table.log_likelihood[i] + share * table.log_likelihood[i + 1];
}

}  // namespace

float hit_log_likelihood(float distance_m, float variance) {
  return look_up(hit_table(), distance_m, variance);
}

MapFit fit_to_map(const MapGrid& grid, const JudgedBeams& beams, const Pose2& T, bool through, std::size_t stride) {
  MapFit fit;
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y);
  const float ox = c * beams.origin_x - s * beams.origin_y + tx, oy = s * beams.origin_x + c * beams.origin_y + ty;
  const float of_map = map_variance(grid);
  const HitTable& table = hit_table();
  std::size_t count = 0, explained = 0, unmapped = 0, contradicting = 0, unknown = 0;
  float sum = 0.0F;
  for (std::size_t i = 0; i < beams.size(); i += stride) {
    ++count;
    const float x = c * beams.x[i] - s * beams.y[i] + tx, y = s * beams.x[i] + c * beams.y[i] + ty;
    const float variance = beams.variance[i] + of_map, distance = grid.distance_at(x, y);
    bool passed = false;
    if (through && beams.range[i] > kBeforeHitM + kBeginM) {
      const float dx = c * beams.dx[i] - s * beams.dy[i], dy = s * beams.dx[i] + c * beams.dy[i];
      const float most = beams.range[i] - kBeforeHitM - kBeginM;
      passed = goes_through(grid, ox + kBeginM * dx, oy + kBeginM * dy, dx, dy, most);
    }
    const bool on = distance * distance < kSigmasExplained * kSigmasExplained * variance;
    if (passed) {
      ++contradicting;
      sum += kThroughLog;
    } else {
      explained += on;
      unmapped += !on;
      unknown += !on && distance > kUnknownM && !grid.is_free_at(x, y);
      sum += look_up(table, distance, variance);
    }
  }
  const double n = count > 0 ? static_cast<double>(count) : 1.0;
  fit.explained = static_cast<double>(explained) / n;
  fit.unmapped = static_cast<double>(unmapped) / n;
  fit.contradicting = static_cast<double>(contradicting) / n;
  fit.unknown = static_cast<double>(unknown) / n;
  fit.hits = count;
  fit.log_likelihood = static_cast<double>(sum);
  return fit;
}

}  // namespace phasescan
