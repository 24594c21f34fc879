/// A keyframe matched with the map of an earlier visit.
#pragma once

#include <optional>

#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"
#include "odometry/registration.hpp"

namespace phasescan {

/// Matches a keyframe with the map of a visit.
/// @param T_map_base     where the keyframe is thought to be
/// @param uncertainty_m  how far that may be off: beyond 0.15 m poses around it are tried where the match is poor
/// @param min_overlap    share of the points that must lie on the map
/// @return empty where they do not, or the match does not converge
/// @cost one registration, or two and a lattice of poses
std::optional<Registration> match_visit(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base,
                                        double uncertainty_m, double min_overlap);

/// Whether an edge holds the position in every direction to a decimetre: in a bare corridor it does not.
bool holds_position(const Eigen::Matrix3d& information);

}  // namespace phasescan
