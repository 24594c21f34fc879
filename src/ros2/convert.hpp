/// Between what ROS 2 says and what the library computes with.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/map/trinary_map.hpp"
#include "ros2/messages.hpp"

namespace phasescan::ros2 {

/// A planar pose in space.
Pose to_pose(const Pose2& pose);
/// x, y and the direction of the x axis. An orientation of all zeros is none.
/// @throws std::invalid_argument "pose: ..." for numbers that are not finite
Pose2 to_pose2(const Pose& pose);

TransformStamped to_transform(Stamp stamp, const std::string& parent, const std::string& child, const Pose2& pose);

/// Slots 0, 1, 6, 7 (x, y) and 35 (turn about z), and those between them (5, 11, 30, 31), row-major 6 x 6.
Covariance6 to_covariance6(const Eigen::Matrix3d& covariance);
/// Of (x, y, theta). One that is not finite, or has a variance below 0, is the default of RViz: 0.5 m, 15 degrees.
Eigen::Matrix3d to_covariance3(const Covariance6& covariance);

PoseWithCovarianceStamped to_pose_message(Stamp stamp, const std::string& frame, const Pose2& pose,
                                          const Eigen::Matrix3d& covariance);

/// -1 unknown, 0 free, 100 occupied.
OccupancyGrid to_grid(const TrinaryMap& map, Stamp stamp, const std::string& frame);
/// Cells from 65 on are occupied, up to 19 free, as map_server has it; others unknown.
/// @throws std::invalid_argument "map.width: ..." for a grid that contradicts itself, or has over 2^28 cells
TrinaryMap to_map(const OccupancyGrid& grid);

}  // namespace phasescan::ros2
