/// What the scans of a stop say of each beam, and what they say as whole revolutions.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "calibrate/stop.hpp"

namespace phasescan {

/// A beam over the scans of one stop.
struct BeamSummary {
  double range = 0.0;     ///< median [m]
  double slope = 0.0;     ///< change of the median range from beam to beam [m]
  std::size_t asked = 0;  ///< scans in which its sector arrived
  std::size_t answers = 0;
  bool smooth = false;  ///< between neighbours two beams to each side that lie on one surface
  double share() const { return asked ? static_cast<double>(answers) / static_cast<double>(asked) : 0.0; }
};

/// A sector that a revolution lacks, in beams.
struct LostSector {
  std::size_t scan = 0, first = 0, count = 0;
};

/// A stop with its summaries.
struct StopBeams {
  Stop stop;
  std::vector<BeamSummary> beams;
  std::vector<LostSector> lost;

  /// Range minus the beam's median; NaN where there is none [m].
  double residual(std::size_t scan, std::size_t beam) const {
    return static_cast<double>(stop.ranges[scan][beam]) - beams[beam].range;
  }
  bool in_lost_sector(std::size_t scan, std::size_t beam) const;
};

/// Sectors of 8 degrees and more, 8 beams at least, in which beams that nearly always answer are silent at once.
StopBeams summarise(Stop stop);

/// Whether a beam's spread says something of the sensor: smooth surface, not too steep, nearly always answering.
bool measures_noise(const BeamSummary& beam);

/// Turn of each scan against the stop's median [beam steps], and the variance of that estimate by noise; NaN where
/// fewer than 30 beams say something.
struct ScanTurns {
  std::vector<double> turns;
  std::vector<double> variances;
};

/// By least squares over how ranges change with slope.
/// @param range_variance   of a beam's range by chance [m^2], by range [m]
/// @param jitter_variance  of a beam's direction [steps^2]
ScanTurns scan_turns(const StopBeams& stop, const std::function<double(double)>& range_variance,
                     double jitter_variance);

/// The largest residual that is noise and not another surface [m].
inline constexpr double kSameSurface_m = 0.3;

}  // namespace phasescan
