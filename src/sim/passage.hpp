/// Keeps rooms passable while they are furnished.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/floor_plan.hpp"

namespace phasescan::sim {

/// A coarse grid of one room: where the middle of a person or a small robot can be.
class PassageGrid {
 public:
  /// @param entrances  points just inside the room's doors
  PassageGrid(const RoomPlan& room, std::vector<Eigen::Vector2d> entrances);

  /// Puts a thing down if all entrances stay connected and most of the free floor can still be reached; false = it
  /// would block.
  bool try_block(const Footprint& thing);

 private:
  bool passable() const;

  double x0_, y0_, cell_;
  int columns_, rows_;
  std::vector<int> entrances_;  ///< cells
  std::vector<std::uint8_t> blocked_;
  mutable std::vector<int> stack_;
  mutable std::vector<std::uint8_t> seen_;
};

}  // namespace phasescan::sim
