/// What a match knows, made believable.
#pragma once

#include <Eigen/Core>

namespace phasescan {

/// Share of a match's formal information that is believed: the points of a scan are not independent of each other.
inline constexpr double kMatchTrust = 0.1;

/// Turns an information or covariance matrix of (x, y, theta) into a frame in which vectors appear turned by `theta`.
Eigen::Matrix3d rotate_information(const Eigen::Matrix3d& matrix, double theta);

/// A symmetric matrix with its negative eigenvalues set to 0.
Eigen::Matrix3d positive_part(const Eigen::Matrix3d& matrix);

/// Standard deviation of the position in the direction that is known least [m].
double largest_deviation(const Eigen::Matrix3d& information);

/// The direction of (x, y, theta) that an information says least about.
struct LeastSeen {
  Eigen::Vector3d direction;    ///< of unit length in (x, y)
  double variance_ratio = 1.0;  ///< of the other direction of (x, y) to this one, 0..1
};
LeastSeen least_seen(const Eigen::Matrix3d& information);

/// Shrinks a covariance of (x, y, theta) until no direction of (x, y) has a standard deviation above `most_m`.
void bound_translation(Eigen::Matrix3d& covariance, double most_m);

/// What a match with that information, in the frame of the new base, leaves open of a step's (x, y), in that of the
/// old.
/// @param turn  from the old base to the new [rad]
Eigen::Matrix2d doubt_of(const Eigen::Matrix3d& seen, double turn);

/// Whether a match with that (believed) information shows the position in every direction: in a bare corridor it does
/// not.
bool sees_both_ways(const Eigen::Matrix3d& information);

}  // namespace phasescan
