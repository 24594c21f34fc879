/// The relations metric of [Kuemmerle09]: relative poses that people verified, against those of a trajectory.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "eval/trajectory_error.hpp"
#include "io/tum.hpp"

namespace phasescan {

/// Pose of the laser at `stamp_b` in its frame at `stamp_a`.
struct Relation {
  Stamp stamp_a = 0;
  Stamp stamp_b = 0;
  Pose2 T_a_b;
};

/// Reads `time_a time_b x y z roll pitch yaw` lines; blank lines and `#` comments are skipped.
/// @throws InputError with the line, SystemError if the file cannot be read.
std::vector<Relation> read_relations(const std::string& path);

/// Errors of the relations that both ends of the trajectory answer: error = inv(relation) * estimate.
struct RelationErrors {
  std::size_t relations = 0;
  std::size_t unanswered = 0;              ///< no pose within the allowed gap of one of the two stamps
  std::vector<double> translation;         ///< [m]
  std::vector<double> rotation;            ///< [rad], absolute
  double worst_translation_stamp_a = 0.0;  ///< where to look first [s]
};

/// @param trajectory  poses of the base, any order
/// @param T_base_laser  where the laser sits: relations are between poses of the laser
RelationErrors relation_errors(std::span<const StampedPose> trajectory, std::span<const Relation> relations,
                               const Pose2& T_base_laser = {}, double max_gap_s = 0.005);

}  // namespace phasescan
