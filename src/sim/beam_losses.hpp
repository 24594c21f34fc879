/// Beams that come and go by what they meet: surface that answers badly, edges.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/beam_cast.hpp"

namespace phasescan::sim {

/// Share of beams lost on a surface besides those lost everywhere. Which patches answer badly depends on the place
/// alone: every sensor, scan and revolution meets the same ones.
/// @param place    where the beam hit, in the world [m]
/// @param by_edge  share lost as an edge is near
double surface_loss(const LidarOptions& lidar, const Eigen::Vector2d& place, double range, double by_edge);

/// Share of each beam's answers that are lost as an edge is near; empty where the sensor loses none.
std::vector<double> edge_losses(const Beams& beams, const LidarOptions& lidar);

}  // namespace phasescan::sim
