/// A simulated drive, and a pose estimated for each of its scans by chaining matches: the base of Fig. 11 and 12.
#pragma once

#include <vector>

#include "eval/paper_kit.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Scans of a moving A1 and where it truly was at each scan's stamp, in the frame of the first.
struct RecordedDrive {
  double speed_mps = 0.0, turn_rate_dps = 0.0;
  std::vector<double> seconds;
  std::vector<Scan> scans;
  std::vector<Pose2> truth;
};

/// The first `length_m` metres of a tour through one simulated flat, at the given speed, with vibration.
/// The way is the same for every speed.
RecordedDrive drive_tour(std::uint64_t seed, double speed_mps, double turn_rate_dps, double length_m);

/// Estimated and true poses of the same scans.
struct Track {
  std::vector<double> seconds;
  std::vector<Pose2> estimate, truth;

  std::vector<double> position_errors() const;
  double max_error() const;
  /// Root mean square of the second difference of the position error: 0 for a curve of the true shape [m].
  double roughness() const;
};
/// Poses of every `stride`-th scan, each matched with the one before and chained, whatever the match says of itself.
/// @param deskew  the velocity of the step before is taken out of both scans
Track chain_matches(const RecordedDrive& drive, const AnyMatchOptions& options, std::size_t stride,
                    bool deskew = false);

}  // namespace phasescan
