/// Point-to-line registration of one scan against a local map.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "phasescan/core/pose2.hpp"
#include "odometry/local_map.hpp"
#include "odometry/map_points.hpp"

namespace phasescan {

struct RegistrationOptions {
  double gate_start_m = 0.3;  ///< distance beyond which points have no partner, first step
  double gate_end_m = 0.1;    ///< the same in the last steps
  int max_iterations = 15;
  double min_normal_cosine = 0.75;
  double stop_m = 2e-4, stop_rad = 4e-5;  ///< a step below both ends the work
};

/// What else is known of the pose: a normal distribution around `T_map_base`.
struct PosePrior {
  Pose2 T_map_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of (x, y, theta) in the frame of the map
};

struct Registration {
  Pose2 T_map_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the match alone, prior not counted, in the frame of
                                                          ///< the map; what noise of the normals pretends to see along
  ///< bare walls is taken out
  double overlap = 0.0;     ///< share of the points with a partner within gate_end_m
  double residual_m = 0.0;  ///< root mean square of the distances across, partners only
  int iterations = 0;
  bool converged = false;
};

/// Finds the pose near `guess` that lays the points on the map's surfaces.
/// Minimises sum rho(e / sigma), e = n . (R p + t - q), with the gate and the kernel shrinking from step to step.
/// @cost about 15 ns a point and step
Registration register_points(const LocalMap& map, const MapPoints& points, const Pose2& guess,
                             const RegistrationOptions& options = {},
                             const std::optional<PosePrior>& prior = std::nullopt);

/// How well a pose explains the points, 0..1: mean over every `stride`-th point of 1 - (distance / reach)^2, 0 without
/// a partner.
double pose_score(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base, std::size_t stride = 1);

/// The best pose of a lattice around `centre` by pose_score: what is asked when tracking may have lost its way.
struct LatticeSearch {
  double half_width_m = 0.6, step_m = 0.2;
  double half_angle_rad = 1.05, step_rad = 0.105;
  std::size_t points = 60;  ///< about so many points are looked at
};
Pose2 search_lattice(const LocalMap& map, const MapPoints& points, const Pose2& centre, const LatticeSearch& lattice,
                     double* best_score = nullptr);

}  // namespace phasescan
