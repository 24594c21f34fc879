/// What places of a map look like: ranges in all directions, in few bytes, and the search for a scan among them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "localize/map_grid.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

inline constexpr std::size_t kViewDirections = 128;
// What all views are compared with first: every fourth direction, every second turn.
inline constexpr std::size_t kCoarseDirections = 32, kCoarseTurns = 64;

/// Ranges as bytes: steps grow with the range, as do differences between views that are near each other.
std::uint8_t view_byte(float range_m);

/// Where a direction's range stands in a view: those of the coarse directions first. Direction d points at d / 128
/// turns, counter-clockwise from x.
inline constexpr std::size_t view_place(std::size_t direction) {
  constexpr std::size_t kEvery = kViewDirections / kCoarseDirections;
  return direction % kEvery * kCoarseDirections + direction / kEvery;
}

/// Views of a map from a lattice of places in its free space.
struct ViewTable {
  std::vector<float> x, y;          ///< of the places, frame of the grid [m]
  std::vector<std::uint8_t> bytes;  ///< kViewDirections each, in the order of view_place
  std::size_t size() const { return x.size(); }
  const std::uint8_t* view(std::size_t i) const { return bytes.data() + i * kViewDirections; }
};

/// @param spacing_m  of the lattice  @param range_m  that a view reaches
ViewTable make_views(const MapGrid& grid, double spacing_m, double range_m);

/// A scan as a view: what it says of each direction, in the laser's frame.
struct ScanView {
  std::array<std::uint8_t, kViewDirections> range{};  ///< by direction
  std::array<std::uint8_t, kViewDirections> known{};  ///< 255 or 0
  std::uint8_t reach = 255;                           ///< no range of the sensor is above this
  std::size_t known_count = 0;
};
ScanView view_of(const Scan& scan);

/// A view and a turn that look like the scan. The laser's heading in the frame of the grid is turn / 128 turns.
struct ViewMatch {
  std::uint32_t view = 0;
  std::uint16_t turn = 0;
  std::uint16_t cost = 0;  ///< sum over all directions of the differences
};

/// Buffers of `match_views`.
struct ViewSearch {
  std::vector<std::uint8_t> coarse_rotated, coarse_most;  ///< a row of turns for each coarse direction
  std::vector<std::uint8_t> rotated, most;                ///< a row of directions for each turn
  std::vector<ViewMatch> best;
};

/// The matches of least cost among all views and turns, best first; of one view at most the two best turns that are no
/// neighbours.
/// @cost about 0.1 us a view, 0.2 us for each match asked for
void match_views(const ViewTable& views, const ScanView& scan, std::size_t most, ViewSearch& search);

}  // namespace phasescan
