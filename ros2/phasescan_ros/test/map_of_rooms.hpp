/// The map of the robot's world, as a map server has it: walls drawn, the inside free, the rest not known.
#pragma once

#include <algorithm>
#include <cmath>
#include <nav_msgs/msg/occupancy_grid.hpp>

#include "support/toy_world.hpp"

namespace phasescan_ros::test {

inline nav_msgs::msg::OccupancyGrid map_of_rooms() {
  constexpr double kCell_m = 0.05, kLeft = -3.5, kBottom = -3.0;
  nav_msgs::msg::OccupancyGrid map;
  map.header.frame_id = "map";
  map.info.resolution = static_cast<float>(kCell_m);
  map.info.width = 260;
  map.info.height = 120;
  map.info.origin.position.x = kLeft;
  map.info.origin.position.y = kBottom;
  map.info.origin.orientation.w = 1.0;
  map.data.assign(std::size_t{map.info.width} * map.info.height, -1);
  const auto cell = [&](double x, double y) -> std::int8_t& {
    const auto column = static_cast<std::size_t>(std::floor((x - kLeft) / kCell_m));
    const auto row = static_cast<std::size_t>(std::floor((y - kBottom) / kCell_m));
    return map.data.at(row * map.info.width + column);
  };
  for (double x = -3.0; x < 9.0; x += kCell_m) {
    for (double y = -2.5; y < 2.5; y += kCell_m) cell(x + 0.5 * kCell_m, y + 0.5 * kCell_m) = 0;
  }
  for (const phasescan::testing::Wall& wall : phasescan::testing::two_rooms()) {
    const double length = (wall.b - wall.a).norm();
    for (double along = 0.0; along <= length; along += 0.2 * kCell_m) {
      const Eigen::Vector2d at = wall.a + (wall.b - wall.a) * (along / length);
      cell(at.x(), at.y()) = 100;
    }
  }
  return map;
}

}  // namespace phasescan_ros::test
