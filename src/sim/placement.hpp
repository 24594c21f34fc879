/// Where the sensors of a pair stand, and what moved between the scans.
#pragma once

#include <optional>

#include "sim/pairs.hpp"

namespace phasescan::sim {

/// Two poses in one world.
struct Placement {
  Pose2 T_world_ref;
  Pose2 T_world_scan;
};

/// A free pose of any heading in one of the rooms; none after many tries.
std::optional<Pose2> draw_pose(const World& world, const RayCaster& caster, double clearance_m, Random& random);

/// Two free poses of the class in sight of each other; through a doorway where the row asks for it. None after many
/// tries.
std::optional<Placement> draw_placement(const World& world, const RayCaster& caster, const PairRow& row, PairClass cls,
                                        Random& random);

/// Objects and people that stand at different places in the two scans, in sight and clear of both poses.
void draw_loose(const RayCaster& caster, const PairRow& row, const LidarOptions& lidar, const Placement& place,
                Shape& loose_ref, Shape& loose_scan, Random& random);

}  // namespace phasescan::sim
