/// What a scan says of every direction: a surface at this range, nothing up to the sensor's reach, or nothing at all.
#pragma once

#include <vector>

#include "phasescan/scan/scan.hpp"
#include "scan/surface.hpp"

namespace phasescan {

/// One entry per bin of direction, bin k covers [k, k + 1) / size() turns counter-clockwise from x forward.
///
/// `near_range` and `far_range` bound what was hit in the bin and its two neighbours [m]. Where the sensor saw nothing
/// in a wide run of beams, `empty_to` is the range up to which a surface should have been seen [m], else 0. Where the
/// sensor did not look at all, near_range = far_range = empty_to = 0.
struct BearingTable {
  std::vector<float> near_range, far_range, empty_to;

  std::size_t size() const { return near_range.size(); }
};

struct BearingWorkspace {
  std::vector<float> low, high;
  std::vector<unsigned char> missing;
};

/// @param hit_turns  direction of every hit [turns], see fill_directions
///
/// Runs of missing beams narrower than `min_empty_run_rad` are lost beams, not emptiness: they say nothing.
/// @cost O(beams + bins)
void fill_bearing_table(const Scan& scan, const SurfacePoints& surface, const float* hit_turns,
                        const SurfaceWorkspace& beams, double twist_turn_per_beam, double min_empty_run_rad,
                        BearingWorkspace& work, BearingTable& out);

}  // namespace phasescan
