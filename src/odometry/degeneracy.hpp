/// Directions that a match leaves open: along a bare corridor walls say where the robot is across, and not how far
/// along.
#pragma once

#include <Eigen/Core>

namespace phasescan {

/// Standard deviation of the position in the direction that is known least [m]; 30 m where nothing is known of it.
double largest_deviation(const Eigen::Matrix3d& information);

/// The direction of (x, y, theta) that an information says least about.
struct WeakDirection {
  Eigen::Vector3d direction;    ///< of unit length in (x, y); theta turns along with it
  double variance_ratio = 1.0;  ///< of the other direction of (x, y) to this one, 0..1: small means degenerate
};
WeakDirection weakest_direction(const Eigen::Matrix3d& information);

/// Largest standard deviation of a position that counts as determined by one scan [m]. Bare corridors leave metres
/// open, rooms millimetres; chosen by hand between them.
inline constexpr double kDeterminedM = 0.2;

/// Whether an information (already scaled by kMatchTrust) determines the position in every direction.
bool determines_position(const Eigen::Matrix3d& information, double most_sigma_m = kDeterminedM);

/// Shrinks a covariance of (x, y, theta) until no direction of (x, y) has a standard deviation above `most_m`.
void bound_translation(Eigen::Matrix3d& covariance, double most_m);

/// Covariance of a step's (x, y) in the frame of the old base, as far as a match determines it: at most 1 m^2 in a
/// direction that it leaves open.
/// @param seen  information of the match in the frame of the new base
/// @param turn  from the old base to the new [rad]
Eigen::Matrix2d step_covariance_of(const Eigen::Matrix3d& seen, double turn);

}  // namespace phasescan
