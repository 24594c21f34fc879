/// Finding room for paths in a world.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/random.hpp"
#include "sim/free_space.hpp"

namespace phasescan::sim {

/// Rounds through a world: from a start through every room that can be reached and back.
class TourPlanner {
 public:
  /// @throws std::invalid_argument where no point of the world is free, or nothing can be reached from any.
  TourPlanner(const World& world, double clearance_m, Random& random);

  /// The next round: a polyline from the start through a free point of each room, nearest first, and back to the start.
  std::vector<Eigen::Vector2d> next_round(Random& random) const;

 private:
  const World& world_;
  FreeSpace space_;
  double clearance_m_;
  Eigen::Vector2d start_ = Eigen::Vector2d::Zero();
  FreeSpace::Distances from_start_;
};

/// A free point in one of the rooms. @throws std::invalid_argument after many tries.
Eigen::Vector2d find_point(const World& world, double clearance_m, Random& random);

/// A pose from which a circle of this radius (left for positive, right for negative) keeps clear. @throws
/// std::invalid_argument
Pose2 find_circle(const World& world, double radius_m, double clearance_m, Random& random);

/// The longest of many free lines, at most 6 m long. @throws std::invalid_argument
std::pair<Eigen::Vector2d, Eigen::Vector2d> find_line(const World& world, double clearance_m, Random& random);

}  // namespace phasescan::sim
