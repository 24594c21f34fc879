/// Nearest surface point by one look into a grid: cheap to build, cheaper to ask.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scan/surface.hpp"

namespace phasescan {

/// Each cell names the point nearest to its centre among those within three cells (in the maximum norm), as far as
/// cells can tell: points in one cell share their first one's entry, so an asker should also look at the neighbours in
/// index.
class NearestGrid {
 public:
  static constexpr int kReachCells = 3;
  static constexpr int kMaxPoints = (1 << 25) - 2;

  /// @param points      at most kMaxPoints
  /// @param half_width  points with |x| or |y| beyond it are left out [m]
  /// @param cell        [m]
  /// @cost  O(cells / 16 + occupied cells), without the first where the grid before was much the same; allocates only
  ///        while it grows
  void build(std::span<const SurfacePoint> points, float half_width, float cell);

  /// Index of a point near (px, py), or -1 where none is within reach.
  int nearest(float px, float py) const {
    const float u = (px + view_.offset) * view_.inverse_cell, v = (py + view_.offset) * view_.inverse_cell;
    if (!(u >= 0.0F && v >= 0.0F && u < view_.limit && v < view_.limit)) return -1;
    return static_cast<int>(keys_[static_cast<std::size_t>(v) * view_.stride + static_cast<std::size_t>(u)] &
                            kIndexMask) -
           1;
  }

  /// What vector code reads: key of cell (u, v) = keys[v * stride + u], index + 1 in its low bits (kIndexMask), 0 =
  /// none.
  struct View {
    const std::uint32_t* keys = nullptr;
    float offset = 0.0F, inverse_cell = 1.0F, limit = 0.0F;
    std::uint32_t stride = 0;
  };
  static constexpr std::uint32_t kIndexMask = (1U << 25) - 1;
  bool empty() const { return keys_.empty(); }
  View view() const {
    View view = view_;
    view.keys = keys_.data();
    return view;
  }

 private:
  View view_;                                     // its pointer stays null: copies of the grid must not share keys
  std::vector<std::uint32_t> corners_, indices_;  // of the occupied cells
  std::size_t occupied_ = 0;                      // how many these are
  std::vector<std::uint32_t> keys_;               // squared distance in cells << 25 | index + 1
};

}  // namespace phasescan
