/// The part of the line fit that works on whole vectors of hits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace phasescan::surface_lines {

/// A line, field by field: centre; normal, not of unit length, and its square; variance along and across; hits.
enum LineField { kCentreX, kCentreY, kNormalX, kNormalY, kNorm2, kSpread, kResidual, kCount, kLineFields };
/// What a hit gets from its line.
enum HitField { kHitNx, kHitNy, kHitLineX, kHitLineY, kHitLength, kHitVariance, kHitNormalVariance, kHitFields };

/// A line is fitted this far to either side, short enough for furniture, and farther where the wall runs on.
inline constexpr double kReachShare = 0.007;  // of the extent
/// A beam along the line (less than about 12 deg apart) is given no more credit.
inline constexpr double kLeastCosine2 = 0.04;

struct LinesTask {
  const double* sums;               ///< before each hit: x, y, xx, xy, yy
  const double *x, *y;              ///< hits [m]
  const float *range, *sigma;       ///< [m]
  const std::int32_t *begin, *end;  ///< the segment
  std::size_t count;                ///< padded to whole vectors
  double spacing, least_reach;      ///< between beams [rad]; of a window [m]
  double straightness;              ///< of the expected variance across the line: a longer line must fit this well
  double least_spread;              ///< of the variance that noise alone has along the line
  std::int32_t* half;               ///< half a window
  double* lines;                    ///< kLineFields arrays of `count`
  float* hits;                      ///< kHitFields arrays of `count`
  std::uint8_t* found;              ///< 1 where a long window has a line
};

/// Half windows, and the lines of the two longest windows, which serve most hits on walls.
void fit_long_lines(const LinesTask& task);
/// From lines to what the hits get.
void finish_hits(const LinesTask& task);

}  // namespace phasescan::surface_lines
