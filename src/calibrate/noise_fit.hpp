/// Range noise by range, jitter of beam directions and turn of whole revolutions, from stops.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrate/beams.hpp"

namespace phasescan {

/// How directions jitter.
struct JitterPattern {
  double neighbour_correlation = 0.0;  ///< of two beams side by side, noise of the ranges taken out
  double period =
      0.0;  ///< beams after which the error repeats, where it grows from beam to beam and jumps back; else 0
};

struct NoiseFit {
  std::vector<double> ranges;     ///< [m], rising
  std::vector<double> variances;  ///< of a range there, rounding included [m^2]
  double jitter_variance = 0.0;   ///< of a beam's direction [steps^2]
  double turn_variance = 0.0;     ///< of a revolution's turn, noise of the estimate taken out [steps^2]
  JitterPattern pattern;
  std::size_t beams = 0;  ///< beams of stops that were used
  std::size_t turns = 0;  ///< scans whose turn could be told

  double range_variance(double range) const;
};

/// A beam's spread is range noise plus slope^2 times jitter, the first one a curve over the range, the second one
/// number; both are fitted to all beams' spreads, the turn of each scan taken out, until they agree.
/// @return nothing where fewer than 40 beams say something
/// @cost   a few passes over all ranges
std::optional<NoiseFit> fit_noise(std::span<const StopBeams> stops);

/// Borders [m] of ranges that each hold at least `least` of the values (sorted), at least a third apart.
std::vector<std::size_t> range_bins(std::span<const double> sorted_ranges, std::size_t least);

}  // namespace phasescan
