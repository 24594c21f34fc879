/// Whether what a log calls odometry is wheel odometry.
#pragma once

#include <map>
#include <string>

#include "phasescan/io/log.hpp"

namespace phasescan {

struct OdometrySource {
  bool usable = false;
  std::string assumed;  ///< what was assumed and why, in words
};

/// Where odometry and corrected poses are the same in every scan: they are corrected ones if a mapping program has left
/// its marks in the log (particle filter states, or odometry lines that the scans' poses do not follow), and then count
/// as none; else they are odometry, written twice.
/// @param facts  of the reader, at the end of the log
OdometrySource source_of_same_poses(const std::map<std::string, std::string>& facts);

/// Looks through a log. Odometry that differs from the log's corrected poses is wheel odometry; where both are the same
/// see above. Of a log without odometry it is not told that there is none: it may begin late.
/// @cost reads the log once where the two are the same, else its first scans
/// @throws as open_log
OdometrySource find_odometry_source(const std::string& path, const LogOptions& options = {});

}  // namespace phasescan
