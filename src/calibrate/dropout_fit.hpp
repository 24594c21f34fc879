/// How often beams do not answer: everywhere by range, on surface that answers badly, and from one revolution to the
/// next.
#pragma once

#include <span>
#include <vector>

#include "calibrate/beams.hpp"

namespace phasescan {

struct DropoutFit {
  std::vector<double> ranges;  ///< [m], rising
  std::vector<double> losses;  ///< share of the beams lost there on good surface
  double patch_share = 0.0;    ///< share of the surface whose beams lose a share anywhere between none and all
  double memory = 0.0;         ///< correlation of a beam's losses from one revolution to the next
  std::size_t beams = 0;
};

/// Beams on smooth surface, met no flatter than 20 degrees, that answered at least once. Lost sectors do not count.
/// @param empty_share  beams that have no sample in a revolution; that is no loss
DropoutFit fit_dropout(std::span<const StopBeams> stops, double empty_share);

/// Correlation m of a beam's losses from one scan to the next, from all its scans: `both` consecutive losses more than
/// the number of its losses makes likely, as a share of what they could be more. A stop is short, so m = 0.5 shows as
/// less; the expectation over `scans` scans is inverted. @param seen  that share
double memory_from_share(double seen, double scans);

}  // namespace phasescan
