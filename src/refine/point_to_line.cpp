#include "refine/point_to_line.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

// The lines are the best of a few tries, and so noisier than their fits say: by so much along bare walls.
constexpr double kNormalNoise = 2.5;

constexpr double kKeepShare = 0.1, kKeepTurn_rad = 0.003;  // of the gate; partners are kept so far

}  // namespace

PointToLineResult refine_point_to_line(const SurfaceModel& reference, const SurfaceModel& scan, const Pose2& guess,
                                       const PointToLineOptions& options, const SurfaceBatch& of_scan,
                                       const SurfaceBatch* of_ref, PointToLineWorkspace& work) {
  PointToLineResult result;
  result.T_ref_scan = guess;
  double gate = options.gate_start_m, moved_m = 0.0, turned_rad = 0.0;
  NormalEquations equations;
  Partners &in_reference = work.in_reference, &in_scan = work.in_scan;
  in_reference.known = in_scan.known = false;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const bool last_gate = gate <= options.gate_end_m;
    const PartnerGate partner_gate{gate, last_gate ? 0.0 : 0.15 * gate, options.min_normal_cosine};
    equations = point_to_line_equations(reference, of_scan, result.T_ref_scan, partner_gate,
                                        last_gate ? &in_reference : nullptr);
    result.partners = equations.partners;
    if (of_ref != nullptr) {
      const NormalEquations back = about_inverse(point_to_line_equations(scan, *of_ref, result.T_ref_scan.inverse(),
                                                                         partner_gate, last_gate ? &in_scan : nullptr),
                                                 result.T_ref_scan);
      equations.H += back.H;
      equations.g += back.g;
      equations.normal_noise += back.normal_noise;
      equations.partners += back.partners;
      equations.cost += back.cost;
    }
    ++result.iterations;
    if (equations.partners < 3) return result;
    // A little damping holds the pose where the surfaces say nothing.
    Eigen::Matrix3d H = equations.H;
    const double translation_scale = 0.5 * (H(0, 0) + H(1, 1));
    H(0, 0) += 1e-3 * translation_scale;
    H(1, 1) += 1e-3 * translation_scale;
    H(2, 2) += 1e-3 * H(2, 2) + 1e-9;
    const Eigen::Vector3d step = -H.ldlt().solve(equations.g);
    if (!step.allFinite()) return result;
    result.T_ref_scan.x += step.x();
    result.T_ref_scan.y += step.y();
    result.T_ref_scan.theta = wrap_angle(result.T_ref_scan.theta + step.z());
    const double moved = std::hypot(step.x(), step.y());
    if (last_gate && moved < options.stop_m && std::abs(step.z()) < options.stop_rad) {
      result.converged = true;
      break;
    }
    if (last_gate) {
      // Partners stay while the pose stays.
      moved_m += moved;
      turned_rad += std::abs(step.z());
      if (moved_m > kKeepShare * gate || turned_rad > kKeepTurn_rad) {
        in_reference.known = in_scan.known = false;
        moved_m = turned_rad = 0.0;
      }
    }
    gate = std::max(options.gate_end_m, 0.6 * gate);
  }
  result.mean_cost = equations.cost / equations.partners;
  result.information = (of_ref != nullptr ? 0.5 : 1.0) * (equations.H - kNormalNoise * equations.normal_noise);
  return result;
}

Eigen::Matrix3d covariance_of_residuals(const SurfaceModel& reference, const SurfaceModel& scan,
                                        const Pose2& T_ref_scan, const PartnerGate& gate, const SurfaceBatch& of_scan,
                                        const SurfaceBatch* of_ref, PointToLineWorkspace& partners,
                                        std::vector<NormalEquations>& work) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), scatter = Eigen::Matrix3d::Zero();
  point_to_line_equations_by_run(reference, of_scan, T_ref_scan, gate, partners.in_reference, work);
  for (const NormalEquations& run : work) {
    H += run.H;
    scatter += run.g * run.g.transpose();
  }
  if (of_ref != nullptr) {
    point_to_line_equations_by_run(scan, *of_ref, T_ref_scan.inverse(), gate, partners.in_scan, work);
    for (const NormalEquations& forth : work) {
      const NormalEquations run = about_inverse(forth, T_ref_scan);
      H += run.H;
      scatter += run.g * run.g.transpose();
    }
    scatter *= 2.0;  // a wall's run errs the same both ways: (g + g) (g + g)' = 2 (g g' + g g')
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(H);
  if (solver.info() != Eigen::Success || !solver.isPositive() || !(solver.rcond() > 1e-12))
    return Eigen::Matrix3d::Zero();
  return solver.solve(solver.solve(scatter).transpose());
}

}  // namespace phasescan
