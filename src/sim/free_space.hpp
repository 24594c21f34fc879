/// Where a robot can go: a grid of distances to the nearest surface, and ways through it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/random.hpp"
#include "sim/world.hpp"

namespace phasescan::sim {

/// Free space of a world at 5 cm. The inside of furniture counts as free but cannot be reached.
class FreeSpace {
 public:
  /// @cost O(area): a distance transform [Felzenszwalb12].
  explicit FreeSpace(const World& world);

  /// Distance to the nearest surface [m], to about a cell; 0 outside the grid.
  double clearance(const Eigen::Vector2d& p) const;

  /// Shortest-path distances [m] from one point to all cells with at least `clearance_m`; infinity where none leads
  /// there.
  class Distances {
   public:
    double at(const Eigen::Vector2d& p) const;

   private:
    friend class FreeSpace;
    const FreeSpace* space_ = nullptr;
    std::vector<float> cost_;
    std::vector<std::int32_t> from_;
  };
  Distances distances_from(const Eigen::Vector2d& start, double clearance_m) const;

  /// The way from the distances' start to a goal as a polyline whose legs all keep the clearance; none if no way leads
  /// there. Legs are pulled straight; the middle of passages is preferred over their walls.
  std::optional<std::vector<Eigen::Vector2d>> way(const Distances& from, const Eigen::Vector2d& goal,
                                                  double clearance_m) const;

 private:
  int index(const Eigen::Vector2d& p) const;
  Eigen::Vector2d center(int index) const;
  bool straight(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double clearance_m) const;

  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> clearance_;
};

}  // namespace phasescan::sim
