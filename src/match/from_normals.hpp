/// Rotation candidates from the directions that surfaces face: no 180-degree twin, for a wall faces one way only.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "scan/surface.hpp"

namespace phasescan {

/// Metres of surface per direction of its normal, kBins bins over the full turn, smoothed.
struct NormalHistogram {
  static constexpr int kBins = 120;
  std::array<float, kBins> weight{};
};

/// Correlation of two histograms for every turn of the second by a whole bin.
using NormalCorrelation = std::array<float, NormalHistogram::kBins>;

/// @param normal_turns  direction of every normal [turns], see fill_directions
/// @cost O(points)
void fill_normal_histogram(const SurfacePoints& surface, const float* normal_turns, NormalHistogram& out);

/// out[k] = sum_b reference[b + k] * scan[b], scaled so that equal histograms give 1: how well the scan turned by
/// k * 360 / kBins degrees faces as the reference does. @cost kBins^2
void correlate_normals(const NormalHistogram& reference, const NormalHistogram& scan, NormalCorrelation& out);

/// Angles of the highest local maxima, best first [rad], in (-pi, pi], into `angles`, which grows at most once.
void normal_peaks(const NormalCorrelation& correlation, int count, std::vector<double>& angles);

}  // namespace phasescan
