/// Point-to-line refinement of a pose in both directions, weighted by the noise of both scans.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "refine/nearest_grid.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// A surface that can be matched against: points in order, the grid that finds them, and the hits that ask for partners
/// in another surface. A submap is one as well, if its points carry normals, variance, length and normal_variance.
struct SurfaceModel {
  const SurfacePoints& points;
  const NearestGrid& grid;
  const SurfaceBatch& all;
};

/// How a refinement goes.
struct PointToLineOptions {
  double gate_start_m = 0.4;  ///< distances beyond it are no partners, in the first step
  double gate_end_m = 0.1;    ///< the same in the last steps
  int max_iterations = 12;
  double min_normal_cosine = 0.75;        ///< normals of partners must agree this well
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
  int partners = 0;        ///< hits of the scan that found a partner in the last step
  double mean_cost = 0.0;  ///< mean of weight * residual^2 over the partners of the last step, both ways
};

/// Partners of a batch's hits as found at one pose, to be used again a little way on.
struct Partners {
  std::vector<std::int32_t> index;  ///< into the model's points, -1 = none; as long as the padded batch
  bool known = false;               ///< false: look for them and note them here
};

/// Buffers of a refinement, kept between calls.
struct PointToLineWorkspace {
  Partners in_reference, in_scan;
};

/// Refines T_ref_scan from `guess`: the hits `of_scan` look for lines in the reference and, unless it is null, the hits
/// `of_ref` for lines in the scan.
///
/// Minimises sum w rho(e), e = n . (R p + t - q) with n, q the line at the partner and w = 1 / (variance of both ranges
/// along n per length of surface); the kernel's width shrinks from gate_start to gate_end, so the first steps weigh all
/// points alike and the last ones as their noise deserves.
/// @cost a few ns a point and step
/// @source [Censi08] for the metric, [Segal09] for weights from both surfaces
PointToLineResult refine_point_to_line(const SurfaceModel& reference, const SurfaceModel& scan, const Pose2& guess,
                                       const PointToLineOptions& options, const SurfaceBatch& of_scan,
                                       const SurfaceBatch* of_ref, PointToLineWorkspace& work);

/// The same with all hits, both ways.
inline PointToLineResult refine_point_to_line(const SurfaceModel& reference, const SurfaceModel& scan,
                                              const Pose2& guess, const PointToLineOptions& options) {
  PointToLineWorkspace work;
  return refine_point_to_line(reference, scan, guess, options, scan.all, &reference.all, work);
}

/// Normal equations of one step about (x, y, theta): step = -H^-1 g.
struct NormalEquations {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  Eigen::Matrix3d normal_noise = Eigen::Matrix3d::Zero();  ///< what noise of the normals adds to H in expectation
  double cost = 0.0;                                       ///< sum of w e^2
  int partners = 0;
};

/// How partners are chosen and weighed in one step.
struct PartnerGate {
  double gate_m = 0.1;  ///< partners are at most this far apart, across and along the line
  double soft_m = 0.0;  ///< widens the kernel and levels the weights; 0: maximum likelihood
  double min_normal_cosine = 0.75;
};

/// Normal equations of `hits` at T_model_hits against the model's lines.
/// @param partners  null, or what keeps the partners from step to step
/// @throws nothing; every CPU gives the same to float rounding.
NormalEquations point_to_line_equations(const SurfaceModel& model, const SurfaceBatch& hits, const Pose2& T_model_hits,
                                        const PartnerGate& gate, Partners* partners = nullptr);

/// Neighbouring hits whose residuals err together: a tenth of a turn of 360 beams. A multiple of
/// SurfaceBatch::kPadding.
constexpr std::size_t kRunOfHits = 32;

/// The equations of each run of kRunOfHits hits, in the order of the hits. Partners that are known are used again.
void point_to_line_equations_by_run(const SurfaceModel& model, const SurfaceBatch& hits, const Pose2& T_model_hits,
                                    const PartnerGate& gate, Partners& partners, std::vector<NormalEquations>& out);

/// Covariance of (x, y, theta) in the reference frame as the residuals at `T_ref_scan` show it: those of neighbouring
/// hits err together (jitter of directions, distortion by motion, furniture that moved), those of runs of hits do not.
/// Zero where the hits do not hold the pose. `of_ref` null: the scan's hits alone.
/// @param partners  those of the refinement that led there, or none
/// @cost that of one step of a refinement
/// @source the sandwich estimator with clustered residuals, [Liang86]
Eigen::Matrix3d covariance_of_residuals(const SurfaceModel& reference, const SurfaceModel& scan,
                                        const Pose2& T_ref_scan, const PartnerGate& gate, const SurfaceBatch& of_scan,
                                        const SurfaceBatch* of_ref, PointToLineWorkspace& partners,
                                        std::vector<NormalEquations>& work);

/// Equations about T^-1 turned into equations about T.
NormalEquations about_inverse(const NormalEquations& equations, const Pose2& T);

}  // namespace phasescan
