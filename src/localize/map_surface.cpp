#include "localize/map_surface.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace phasescan {
namespace {

constexpr float kLineReachM = 0.22F;    // a line is fitted to the border within this
constexpr float kSoftnessCells = 0.6F;  // of the distance across at which a border cell counts half
constexpr int kFitPasses = 3;
// Surfaces lie between the middle of the cells that show them, where those of a map made by hits are, and the side that
// faces free space, where those of a drawn one are [cells].
constexpr float kTowardsFree = 0.25F;
constexpr float kFacingFree = 0.3F;  // mean of the free neighbours' directions along the normal
constexpr float kNormalVariance = 0.06F * 0.06F;
// Where a wall lies within its cells is known no better than this, of a cell; errors are the same along a whole wall.
constexpr float kWithinCell = 0.3F;
constexpr float kPointsPerSurfel = 2.0F;

struct BorderLine {
  float x = 0, y = 0, nx = 0, ny = 0;
  bool found = false;
};

/// Cells at the border of occupied space, and where free cells lie around each.
struct Border {
  std::vector<std::uint8_t> is;
  std::vector<std::int8_t> free_x, free_y;  ///< sums of the free neighbours' directions

  /// Whether two cells may be of one face of a wall: those of the other face see free space the other way.
  bool same_face(std::size_t a, std::size_t b) const { return free_x[a] * free_x[b] + free_y[a] * free_y[b] >= 0; }
};

Border border_of(const MapGrid& grid) {
  Border border;
  border.is.assign(grid.occupied.size(), 0);
  border.free_x.assign(grid.occupied.size(), 0);
  border.free_y.assign(grid.occupied.size(), 0);
  for (int k = 0; k < grid.height; ++k) {
    for (int i = 0; i < grid.width; ++i) {
      const std::size_t at = grid.index(i, k);
      if (!grid.occupied[at]) continue;
      border.is[at] =
          grid.is_free(i - 1, k) || grid.is_free(i + 1, k) || grid.is_free(i, k - 1) || grid.is_free(i, k + 1);
      int x = 0, y = 0;
      for (int b = -1; border.is[at] && b <= 1; ++b) {
        for (int a = -1; a <= 1; ++a) {
          if (grid.is_free(i + a, k + b)) x += a, y += b;
        }
      }
      border.free_x[at] = static_cast<std::int8_t>(x), border.free_y[at] = static_cast<std::int8_t>(y);
    }
  }
  return border;
}

/// The line through the border around a cell, in cells about its middle; cells off the line lose their weight.
BorderLine fit_line(const MapGrid& grid, const Border& border, int i, int k, int reach) {
  BorderLine line;
  const std::size_t here = grid.index(i, k);
  for (int pass = 0; pass < kFitPasses; ++pass) {
    float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (int b = std::max(0, k - reach); b <= std::min(grid.height - 1, k + reach); ++b) {
      for (int a = std::max(0, i - reach); a <= std::min(grid.width - 1, i + reach); ++a) {
        const std::size_t there = grid.index(a, b);
        if (!border.is[there] || !border.same_face(here, there)) continue;
        const auto px = static_cast<float>(a - i), py = static_cast<float>(b - k);
        float weight = 1.0F;
        if (pass > 0) {
          const float across = ((px - line.x) * line.nx + (py - line.y) * line.ny) / kSoftnessCells;
          weight = 1.0F / (1.0F + across * across);
          weight *= weight;
        }
        n += weight, x += weight * px, y += weight * py;
        xx += weight * px * px, xy += weight * px * py, yy += weight * py * py;
      }
    }
    if (n < 2.5F) return line;
    line.x = x / n, line.y = y / n;
    xx = xx / n - line.x * line.x, xy = xy / n - line.x * line.y, yy = yy / n - line.y * line.y;
    const float along = 0.5F * std::atan2(2.0F * xy, xx - yy);
    line.nx = -std::sin(along), line.ny = std::cos(along);
    const float spread = xx + yy, across = xx * line.nx * line.nx + 2 * xy * line.nx * line.ny + yy * line.ny * line.ny;
    line.found = across < 0.15F * spread;
  }
  return line;
}

void add(MapPoints& out, float x, float y, float nx, float ny, float variance) {
  out.x.push_back(x);
  out.y.push_back(y);
  out.nx.push_back(nx);
  out.ny.push_back(ny);
  out.variance.push_back(variance);
  out.normal_variance.push_back(kNormalVariance);
  out.free_standing.push_back(0);
  if (nx != 0.0F || ny != 0.0F) ++out.with_normal;
}

/// How well the free cells around a cell lie along a direction: that of the best one, 0..1.
float facing_free(const MapGrid& grid, int i, int k, float nx, float ny) {
  float best = 0.0F;
  for (int b = -1; b <= 1; ++b) {
    for (int a = -1; a <= 1; ++a) {
      if ((a == 0 && b == 0) || !grid.is_free(i + a, k + b)) continue;
      const float inverse_length = a != 0 && b != 0 ? 0.7071F : 1.0F;
      best = std::max(best, inverse_length * (static_cast<float>(a) * nx + static_cast<float>(b) * ny));
    }
  }
  return best;
}

}  // namespace

MapPoints map_surface(const MapGrid& grid) {
  const Border border = border_of(grid);
  const int reach = std::max(2, static_cast<int>(std::lround(kLineReachM * grid.inverse_cell)));
  const float within = kWithinCell * grid.cell_m;
  const float variance = kPointsPerSurfel * within * within;
  MapPoints out;
  for (int k = 0; k < grid.height; ++k) {
    for (int i = 0; i < grid.width; ++i) {
      if (!border.is[grid.index(i, k)]) continue;
      const BorderLine line = fit_line(grid, border, i, k, reach);
      const float cx = (static_cast<float>(i) + 0.5F) * grid.cell_m, cy = (static_cast<float>(k) + 0.5F) * grid.cell_m;
      if (!line.found) {
        add(out, cx, cy, 0.0F, 0.0F, variance);
        continue;
      }
      const float across = (line.x * line.nx + line.y * line.ny) * grid.cell_m;
      for (const float side : {-1.0F, 1.0F}) {
        const float nx = side * line.nx, ny = side * line.ny;
        if (facing_free(grid, i, k, nx, ny) <= kFacingFree) continue;
        const float out_of_line = kTowardsFree * grid.cell_m;
        add(out, cx + across * line.nx + out_of_line * nx, cy + across * line.ny + out_of_line * ny, nx, ny, variance);
      }
    }
  }
  return out;
}

}  // namespace phasescan
