#include "slam/visit_match.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kHoldsM = 0.1;  // standard deviation

// When poses around the guess are tried.
constexpr double kDoubtfulOverlap = 0.1;  // above min_overlap: a match with less may have begun too far off
constexpr double kInReachM = 0.15;        // half of the registration's first gate: from there it finds its way
constexpr double kBetterOverlap = 0.05;   // that another pose must gain to be taken
constexpr double kGatedM = 0.2, kGatedRad = 0.1, kRadPerM = 0.1;  // half widths: at no uncertainty, and for each metre
constexpr double kWidestM = 1.2, kWidestRad = 0.35;               // half widths at most
constexpr double kStepM = 0.2, kStepRad = 0.05;                   // of the lattice: what registration bridges

// Along a degenerate direction a match stays where it was begun.
constexpr double kDegenerate = 0.02;  // ratio of information below which a direction counts as not observed
constexpr double kShiftStepM = 0.1;
constexpr int kShiftSteps = 10;      // to either side: 1 m, as far as loops reach without large corrections
constexpr double kLeastGain = 0.01;  // of the score, for another place to be taken

/// Looks along a degenerate direction, a corridor's, for a place where more of the keyframe fits.
Registration search_degenerate_direction(const LocalMap& map, const MapPoints& points, const Registration& found) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(found.information.topLeftCorner<2, 2>());
  if (eigen.eigenvalues()(0) > kDegenerate * eigen.eigenvalues()(1)) return found;
  const Eigen::Vector2d along = eigen.eigenvectors().col(0);
  double best = pose_score(map, points, found.T_map_base) + kLeastGain;
  Pose2 best_pose = found.T_map_base;
  bool moved = false;
  for (int k = 1; k <= kShiftSteps; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d shift = side * k * kShiftStepM * along;
      const Pose2 pose{found.T_map_base.x + shift.x(), found.T_map_base.y + shift.y(), found.T_map_base.theta};
      const double score = pose_score(map, points, pose);
      if (score > best) best = score, best_pose = pose, moved = true;
    }
  }
  if (!moved) return found;
  const Registration again = register_points(map, points, best_pose);
  return pose_score(map, points, again.T_map_base) > best - kLeastGain ? again : found;
}

}  // namespace

bool holds_position(const Eigen::Matrix3d& information) {
  return largest_deviation(information) < kHoldsM;
}

std::optional<Registration> match_visit(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base,
                                        double uncertainty_m, double min_overlap) {
  Registration found = register_points(map, points, T_map_base);
  if (found.overlap < min_overlap + kDoubtfulOverlap && uncertainty_m > kInReachM) {
    LatticeSearch lattice;
    lattice.half_width_m = std::min(kWidestM, kGatedM + uncertainty_m);
    lattice.step_m = kStepM;
    lattice.half_angle_rad = std::min(kWidestRad, kGatedRad + kRadPerM * uncertainty_m);
    lattice.step_rad = kStepRad;
    const Registration again = register_points(map, points, search_lattice(map, points, T_map_base, lattice));
    if (again.overlap > found.overlap + kBetterOverlap) found = again;
  }
  if (found.overlap < min_overlap) return std::nullopt;
  found = search_degenerate_direction(map, points, found);
  if (found.overlap < min_overlap || !found.converged) return std::nullopt;
  return found;
}

}  // namespace phasescan
