// The toy world as a map of cells, as a mapping run would leave it.
#pragma once

#include <cmath>

#include "phasescan/map/trinary_map.hpp"
#include "support/toy_world.hpp"

namespace phasescan::testing {

/// Cells that walls run through are occupied, those that can be reached from `inside` free, the rest unknown. The frame
/// of the map is that of the world, its image turned by `yaw`.
inline TrinaryMap toy_map(const std::vector<Wall>& walls, const Eigen::Vector2d& inside, double resolution_m = 0.05,
                          double yaw = 0.0) {
  const Pose2 T_image_world{0.0, 0.0, -yaw};
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  for (const Wall& w : walls) {
    for (const Eigen::Vector2d& p : {T_image_world * w.a, T_image_world * w.b}) {
      x0 = std::min(x0, p.x()), y0 = std::min(y0, p.y()), x1 = std::max(x1, p.x()), y1 = std::max(y1, p.y());
    }
  }
  x0 -= 0.53, y0 -= 0.47;  // walls do not lie along cells
  TrinaryMap map;
  map.resolution_m = resolution_m;
  map.width = static_cast<int>(std::ceil((x1 + 0.5 - x0) / resolution_m));
  map.height = static_cast<int>(std::ceil((y1 + 0.5 - y0) / resolution_m));
  map.origin = T_image_world.inverse() * Pose2{x0, y0, 0.0};
  map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), CellState::kUnknown);
  const auto at = [&](const Eigen::Vector2d& p) -> CellState& {
    const auto i = static_cast<std::size_t>((p.x() - x0) / resolution_m);
    const auto k = static_cast<std::size_t>((p.y() - y0) / resolution_m);
    return map.cells[k * static_cast<std::size_t>(map.width) + i];
  };
  for (const Wall& w : walls) {
    const Eigen::Vector2d a = T_image_world * w.a, b = T_image_world * w.b;
    const int steps = 1 + static_cast<int>((b - a).norm() / (0.2 * resolution_m));
    for (int s = 0; s <= steps; ++s) at(a + (b - a) * s / steps) = CellState::kOccupied;
  }
  std::vector<std::size_t> todo;
  CellState& first = at(T_image_world * inside);
  first = CellState::kFree;
  todo.push_back(static_cast<std::size_t>(&first - map.cells.data()));
  const auto width = static_cast<std::size_t>(map.width);
  while (!todo.empty()) {
    const std::size_t cell = todo.back();
    todo.pop_back();
    for (const std::size_t next : {cell - 1, cell + 1, cell - width, cell + width}) {
      if (next >= map.cells.size() || map.cells[next] != CellState::kUnknown) continue;
      map.cells[next] = CellState::kFree;
      todo.push_back(next);
    }
  }
  return map;
}

}  // namespace phasescan::testing
