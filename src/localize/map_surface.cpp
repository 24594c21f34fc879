#include "localize/map_surface.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace phasescan {
namespace {

constexpr float kLineReachM = 0.22F;    // a line is fitted to the border within this
constexpr float kSoftnessCells = 0.6F;  // of the distance across at which a border cell counts half
constexpr int kFitPasses = 3;
constexpr float kFacingFree = 0.3F;  // mean of the free neighbours' directions along the normal
constexpr float kNormalVariance = 0.06F * 0.06F;
// Where a wall lies within its cells is known no better than this, of a cell; errors are the same along a whole wall.
constexpr float kWithinCell = 0.3F;
constexpr float kPointsPerSurfel = 2.0F;

struct BorderLine {
  float x = 0, y = 0, nx = 0, ny = 0;
  bool found = false;
};

std::vector<std::uint8_t> border_of(const MapGrid& grid) {
  std::vector<std::uint8_t> border(grid.occupied.size(), 0);
  for (int k = 0; k < grid.height; ++k) {
    for (int i = 0; i < grid.width; ++i) {
      if (!grid.occupied[grid.index(i, k)]) continue;
      border[grid.index(i, k)] =
          grid.is_free(i - 1, k) || grid.is_free(i + 1, k) || grid.is_free(i, k - 1) || grid.is_free(i, k + 1);
    }
  }
  return border;
}

/// The line through the border around a cell, in cells about its middle; cells off the line lose their weight.
BorderLine fit_line(const MapGrid& grid, const std::vector<std::uint8_t>& border, int i, int k, int reach) {
  BorderLine line;
  for (int pass = 0; pass < kFitPasses; ++pass) {
    float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (int b = std::max(0, k - reach); b <= std::min(grid.height - 1, k + reach); ++b) {
      for (int a = std::max(0, i - reach); a <= std::min(grid.width - 1, i + reach); ++a) {
        if (!border[grid.index(a, b)]) continue;
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

/// Mean direction of the free cells around a cell.
void free_direction(const MapGrid& grid, int i, int k, float& x, float& y, float& along_n, float nx, float ny) {
  x = y = along_n = 0.0F;
  for (int b = -1; b <= 1; ++b) {
    for (int a = -1; a <= 1; ++a) {
      if ((a == 0 && b == 0) || !grid.is_free(i + a, k + b)) continue;
      const float length = a != 0 && b != 0 ? 0.7071F : 1.0F;
      x += length * static_cast<float>(a), y += length * static_cast<float>(b);
      along_n = std::max(along_n, length * (static_cast<float>(a) * nx + static_cast<float>(b) * ny));
    }
  }
}

}  // namespace

MapPoints map_surface(const MapGrid& grid) {
  const std::vector<std::uint8_t> border = border_of(grid);
  const int reach = std::max(2, static_cast<int>(std::lround(kLineReachM * grid.inverse_cell)));
  const float within = kWithinCell * grid.cell_m;
  const float variance = kPointsPerSurfel * within * within;
  MapPoints out;
  for (int k = 0; k < grid.height; ++k) {
    for (int i = 0; i < grid.width; ++i) {
      if (!border[grid.index(i, k)]) continue;
      const BorderLine line = fit_line(grid, border, i, k, reach);
      const float cx = (static_cast<float>(i) + 0.5F) * grid.cell_m, cy = (static_cast<float>(k) + 0.5F) * grid.cell_m;
      if (!line.found) {
        add(out, cx, cy, 0.0F, 0.0F, variance);
        continue;
      }
      const float across = (line.x * line.nx + line.y * line.ny) * grid.cell_m;
      for (const float side : {-1.0F, 1.0F}) {
        const float nx = side * line.nx, ny = side * line.ny;
        float fx = 0, fy = 0, facing = 0;
        free_direction(grid, i, k, fx, fy, facing, nx, ny);
        if (facing > kFacingFree) add(out, cx + across * line.nx, cy + across * line.ny, nx, ny, variance);
      }
    }
  }
  return out;
}

}  // namespace phasescan
