/// The last pose of a localisation node as a file: where to begin after a restart.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan::ros2 {

struct SavedPose {
  Stamp stamp = 0;
  Pose2 T_map_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

/// Whole or not at all. @throws SystemError
void write_saved_pose(const std::string& file, const SavedPose& pose);
/// Nothing for a file that is not there. @throws InputError for one that holds something else, SystemError
std::optional<SavedPose> read_saved_pose(const std::string& file);

}  // namespace phasescan::ros2
