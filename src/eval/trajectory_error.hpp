/// How far a trajectory is from another: ATE and RPE as the evo tool defines them (planar, no scale).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "io/tum.hpp"

namespace phasescan {

/// Statistics of a list of errors, as evo prints them (population standard deviation).
struct ErrorStats {
  std::size_t n = 0;
  double rmse = 0.0, mean = 0.0, median = 0.0, std = 0.0, min = 0.0, max = 0.0, sse = 0.0;
};
ErrorStats error_stats(std::span<const double> errors);

/// Poses of two trajectories that belong together, in order.
struct AssociatedPoses {
  std::vector<Pose2> estimate;
  std::vector<Pose2> reference;
};

/// Pairs every pose of the shorter trajectory with the nearest in time of the longer one, if no more than `max_gap_s`
/// apart.
/// @cost O(n log m). Stamps need not be in order.
AssociatedPoses associate(std::span<const StampedPose> estimate, std::span<const StampedPose> reference,
                          double max_gap_s = 0.01);

/// The rigid motion T_reference_estimate that brings the estimate's positions nearest to the reference's in the
/// least-squares sense (Umeyama without scale [Ume91]). Identity for empty input, a pure shift for one pose.
Pose2 align_se2(const AssociatedPoses& poses);

/// Absolute trajectory error after alignment: distances between positions [m], one per pair.
std::vector<double> absolute_trajectory_errors(const AssociatedPoses& poses, bool align = true);

/// How far headings differ after alignment of the positions [rad], one per pair.
std::vector<double> absolute_rotation_errors(const AssociatedPoses& poses, bool align = true);

/// What separates the two ends of a step in the relative pose error.
enum class StepUnit { kFrames, kMetres };

/// Relative pose error, E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j), one value per step.
struct RelativeErrors {
  std::vector<double> translation;  ///< |E| [m]
  std::vector<double> rotation;     ///< |angle of E| [rad]
};

/// RPE over steps that follow each other: every `delta` frames, or every time the estimate has gone `delta` metres.
/// @throws std::invalid_argument for delta <= 0.
RelativeErrors relative_pose_errors(const AssociatedPoses& poses, double delta = 1.0,
                                    StepUnit unit = StepUnit::kFrames);

}  // namespace phasescan
