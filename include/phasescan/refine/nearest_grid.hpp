/// Nearest surface point by one look into a grid: cheap to build, cheaper to ask.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/scan/surface.hpp"

namespace phasescan {

/// Each cell names the point nearest to its centre among those within three cells (in the maximum norm), as far as cells can
/// tell: points in one cell share their first one's entry, so an asker should also look at the neighbours in index.
class NearestGrid {
 public:
  static constexpr int kReachCells = 3;
  static constexpr int kMaxPoints = (1 << 25) - 2;

  /// @param points      at most kMaxPoints
  /// @param half_width  points with |x| or |y| beyond it are left out [m]
  /// @param cell        [m]
  /// @cost  O(cells / 16 + occupied cells); allocates only while it grows
  void build(std::span<const SurfacePoint> points, float half_width, float cell);

  /// Index of a point near (px, py), or -1 where none is within reach.
  int nearest(float px, float py) const {
    const float u = (px + offset_) * inverse_cell_, v = (py + offset_) * inverse_cell_;
    if (!(u >= 0.0F && v >= 0.0F && u < limit_ && v < limit_)) return -1;
    return static_cast<int>(keys_[static_cast<std::size_t>(static_cast<int>(v)) * stride_ + static_cast<std::size_t>(static_cast<int>(u))] & kIndexMask) - 1;
  }

  float cell() const { return cell_; }
  bool empty() const { return keys_.empty(); }

 private:
  static constexpr std::uint32_t kIndexMask = (1U << 25) - 1;
  float offset_ = 0.0F, inverse_cell_ = 1.0F, limit_ = 0.0F, cell_ = 1.0F;
  std::size_t stride_ = 0;
  std::vector<std::uint32_t> keys_;  // squared distance in cells << 25 | index + 1; kNone has index part 0
};

}  // namespace phasescan
