/// A map as cells that are no finer than they need be, with the distance of each to the nearest surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "phasescan/map/trinary_map.hpp"

namespace phasescan {

/// Frame "grid": its origin is the lower-left corner of the map's image, x runs along its rows.
struct MapGrid {
  static constexpr float kPerCell = 8.0F;  ///< distances are kept in eighths of a cell
  static constexpr int kMostDistance = 255;

  int width = 0, height = 0;
  float cell_m = 0.05F, inverse_cell = 20.0F;
  std::vector<std::uint8_t> free, occupied;  ///< 1 or 0
  std::vector<std::uint8_t> distance;        ///< to the nearest occupied cell, from middle to middle

  std::size_t index(int i, int k) const {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
  }
  bool inside(int i, int k) const { return i >= 0 && k >= 0 && i < width && k < height; }
  bool is_free(int i, int k) const { return inside(i, k) && free[index(i, k)] != 0; }
  bool is_free_at(float x, float y) const {
    return x >= 0.0F && y >= 0.0F && is_free(static_cast<int>(x * inverse_cell), static_cast<int>(y * inverse_cell));
  }
  bool is_occupied(int i, int k) const { return inside(i, k) && occupied[index(i, k)] != 0; }
  float most_distance_m() const { return static_cast<float>(kMostDistance) / kPerCell * cell_m; }

  /// Distance of a point to the nearest surface [m], interpolated; most_distance_m() outside the grid.
  float distance_at(float x, float y) const;
  /// Range at which a ray from (x, y) in the direction (dx, dy) meets an occupied cell [m]; `most` where it meets none.
  float cast(float x, float y, float dx, float dy, float most) const;
};

/// Cells of at least 4 cm are taken as they are; finer ones are merged: occupied where any of them is, free where more
/// of the others are free than not. @cost O(cells)
MapGrid make_map_grid(const TrinaryMap& map);
/// The same without distances: an eighth of its time.
MapGrid make_map_cells(const TrinaryMap& map);

}  // namespace phasescan
