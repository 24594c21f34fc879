/// A map as map_server knows it, and the surfaces in it that most beams do not see.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "phasescan/core/pose2.hpp"

namespace phasescan {

enum class CellState : std::int8_t { kUnknown = -1, kFree = 0, kOccupied = 100 };

struct TrinaryMap {
  int width = 0;   ///< cells along x
  int height = 0;  ///< cells along y
  double resolution_m = 0.05;
  Pose2 origin;                  ///< pose of the lower-left corner of cell (0, 0) on the map
  std::vector<CellState> cells;  ///< row-major from the lower left: cells[k * width + i]

  CellState at(int i, int k) const {
    return cells[static_cast<std::size_t>(k) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
  }
};

/// Glass answers beams that meet it head on only, black surfaces those from near only.
enum class GlassKind : std::uint8_t {
  kGlass,  ///< answered head on, was looked through obliquely
  kBlack,  ///< swallows beams: nothing came back, though there is something behind it, or it answered from near or head
           ///< on
};

/// A straight piece of such a surface, frame of the map [m].
struct GlassPane {
  Eigen::Vector2d a, b;
  GlassKind kind = GlassKind::kGlass;
  bool sure = false;         ///< enough views, from places far enough apart
  std::size_t views = 0;     ///< scans that show it
  std::size_t hits = 0;      ///< beams that it answered
  std::size_t through = 0;   ///< beams that ended behind it
  std::size_t vanished = 0;  ///< beams that should have come back and did not

  double length() const { return (b - a).norm(); }
};

}  // namespace phasescan
