/// Point-to-line refinement of a pose in both directions, weighted by the noise of both scans.
#pragma once

#include <Eigen/Core>
#include <span>

#include "phasescan/core/pose2.hpp"
#include "phasescan/refine/nearest_grid.hpp"
#include "phasescan/scan/surface.hpp"

namespace phasescan {

/// A surface that can be matched against: points in order and the grid that finds them. A submap is one as well, if its
/// points carry normals, sigma, length and support (the viewpoint itself plays no part).
struct SurfaceModel {
  const SurfacePoints& points;
  const NearestGrid& grid;
};

/// How a refinement goes.
struct PointToLineOptions {
  double gate_start_m = 0.4;   ///< distances beyond it are no partners, in the first step
  double gate_end_m = 0.1;     ///< the same in the last steps
  int max_iterations = 12;
  double min_normal_cosine = 0.75;   ///< normals of partners must agree this well
  double stop_m = 2e-4, stop_rad = 5e-5;  ///< a step below both ends the work
};

/// What came of it.
struct PointToLineResult {
  Pose2 T_ref_scan;
  /// Information of (x, y, theta) in the reference frame about the scan's origin, as the noise of both scans leaves it:
  /// the Cramer-Rao information over the matched surface, freed of what noisy normals seem to add.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int iterations = 0;
  bool converged = false;
  int partners = 0;   ///< hits of the scan that found a partner in the last step
};

/// Refines T_ref_scan from `guess` with the scan's points `scan_subset` (all where empty) and, if `both_ways`, the
/// reference's points `ref_subset` as well.
///
/// Minimises sum w rho(e), e = n . (R p + t - q) with n, q the line at the partner and w = 1 / (variance of both ranges along
/// n per length of surface); the kernel's width shrinks from gate_start to gate_end, so the first steps weigh all points
/// alike and the last ones as their noise deserves.
/// @cost about 20 ns a point and step
/// @source [Censi08] for the metric, [Segal09] for symmetric weights
PointToLineResult refine_point_to_line(const SurfaceModel& reference, const SurfaceModel& scan, const Pose2& guess,
                                       const PointToLineOptions& options, std::span<const int> scan_subset = {},
                                       std::span<const int> ref_subset = {}, bool both_ways = true);

/// Normal equations of one step, for tests and covariance: H, g with step = -H^-1 g.
struct NormalEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  Eigen::Matrix3d normal_noise = Eigen::Matrix3d::Zero();  ///< what noise of the normals adds to H in expectation
  double cost = 0.0;
  int partners = 0;
};

/// Adds the scan's points against the reference's lines at T_ref_scan (`forward`), or, seen from the reference, the
/// reference's points against the scan's lines. Partners are at most `gate_m` apart; `soft_m` widens the kernel and levels the
/// weights (0: maximum likelihood).
void add_forward(const SurfaceModel& reference, const SurfacePoints& scan, std::span<const int> subset, const Pose2& T_ref_scan,
                 double gate_m, double soft_m, double min_normal_cosine, NormalEquations& sum);
void add_backward(const SurfacePoints& reference, const SurfaceModel& scan, std::span<const int> subset, const Pose2& T_ref_scan,
                  double gate_m, double soft_m, double min_normal_cosine, NormalEquations& sum);

}  // namespace phasescan
