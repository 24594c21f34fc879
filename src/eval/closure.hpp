/// Where a tour comes back: what two scans of one place, long apart, say of each other, against what the trajectory
/// says.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "phasescan/io/log.hpp"
#include "io/tum.hpp"

namespace phasescan {

struct ClosureOptions {
  double near_m = 1.0;        ///< two scans see the same place when no farther apart
  double min_overlap = 0.4;   ///< of a match that is held against the trajectory: less may be two places alike
  std::size_t most = 200;     ///< returns that are looked at, evenly spread
  double apart_share = 0.25;  ///< of the log that lies between the two scans of a return
};

/// A return: the later of two scans of one place, and how far the trajectory is off there.
struct Return {
  std::size_t first = 0, second = 0;  ///< indices of the two scans
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

struct Closure {
  std::size_t looked_at = 0;    ///< pairs of scans that were matched
  std::vector<Return> returns;  ///< those whose match can be trusted, in order of the log
};

/// Matches scans of one place with no guess (global) and compares with the trajectory's own relative poses.
/// @param log         read from its beginning
/// @param trajectory  one pose of the base per scan, in the order of the log
/// @throws std::invalid_argument if the log has not as many scans as the trajectory has poses
Closure closure_errors(LogReader& log, std::span<const StampedPose> trajectory, const ClosureOptions& options = {});

}  // namespace phasescan
