/// A coarse map of one scan with a small score per cell: what a point of the other scan is worth where it would fall.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scan/bearing_table.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// Scores of the cells, 0..kMaxScore: small integers, so that thirty of them add up within a byte.
struct ScoreTableValues {
  std::uint8_t surface = 8;  ///< a hit lies in the cell
  std::uint8_t beside = 6;   ///< a hit lies in a neighbouring cell
  std::uint8_t unknown = 3;  ///< the scan says nothing of the cell
  std::uint8_t empty = 2;    ///< the sensor saw nothing in that direction
  std::uint8_t free = 0;     ///< a beam went through the cell
};

/// Square of kCells x kCells cells around the sensor, framed by kFrame cells of `unknown`, row-major, row = y.
class ScoreTable {
 public:
  static constexpr int kCells = 64;
  static constexpr int kFrame = 32;
  static constexpr int kStride = kCells + 2 * kFrame;
  static constexpr int kMaxScore = 8;

  /// The table reaches `half_width_m` from the sensor in x and y.
  /// @cost O(kCells^2 + hits); allocates once
  void build(const SurfacePoints& surface, const BearingTable& bearings, double half_width_m,
             const ScoreTableValues& values);

  const std::uint8_t* data() const { return cells_.data(); }
  float cell() const { return cell_; }
  const ScoreTableValues& values() const { return values_; }
  /// Column or row of a coordinate, counted from the frame's corner, not rounded.
  float position(float metres) const { return metres * inverse_cell_ + 0.5F * static_cast<float>(kStride); }

 private:
  std::vector<std::uint8_t> cells_;
  std::size_t bins_ = 0;                    // of the last bearings
  std::vector<std::uint16_t> bin_of_cell_;  // of the inner cells, for so many bins
  std::vector<float> limit_;                // of each bin, in cells, see ScoreRow
  float cell_ = 1.0F, inverse_cell_ = 1.0F;
  ScoreTableValues values_;
};

}  // namespace phasescan
