/// The probability that a pose on a map is right.
#pragma once

#include <vector>

#include "localize/global_search.hpp"

namespace phasescan {

/// What tells right poses from wrong ones.
struct PoseEvidence {
  double margin = 0.0;     ///< of log-likelihood, to the next pose apart from it
  double explained = 0.0;  ///< share of the hits
  double contradicting = 0.0;
  double sigma_m = 0.0;  ///< largest standard deviation of the position
};
PoseEvidence evidence_of(const FoundPose& pose, double margin);

/// Calibrated: the share of such poses that are within 0.1 m and 3 deg of the truth.
double pose_confidence(const PoseEvidence& evidence);

/// The same of a pose that views on the way have tested: the margin tells nearly all, and furniture that was moved
/// since takes little from it.
/// @param led_there  odometry leads to it from a pose that was ok
double drive_confidence(const PoseEvidence& evidence, bool led_there);

/// Margin that counts where no other pose was found.
inline constexpr double kMostMargin = 60.0;

}  // namespace phasescan
