/// Trajectories in TUM format: `stamp x y z qx qy qz qw`, seconds and metres, one pose per line.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan {

struct StampedPose {
  Stamp stamp = 0;
  Pose2 pose;
};

/// Lines in the order given: nine decimals of the stamp, planar quaternion (0, 0, sin(theta/2), cos(theta/2)).
std::string format_tum(std::span<const StampedPose> poses);

/// Reads exactly eight numbers per line; blank lines and `#` comments are skipped. The heading is the yaw of the
/// quaternion.
/// @throws InputError with the line for anything else, SystemError if the file cannot be read.
std::vector<StampedPose> read_tum(const std::string& path);

}  // namespace phasescan
