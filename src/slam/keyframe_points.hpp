/// The points of a keyframe, kept small: a long run has ten thousand of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "odometry/map_points.hpp"

namespace phasescan {

/// Map points in 10 bytes each instead of 25. Positions to a 65,000th of the farthest coordinate (0.2 mm of 12 m),
/// normals to 0.1 mrad, variances to 1 %: a tenth of what the range noise of any laser leaves open, and less.
class KeyframePoints {
 public:
  KeyframePoints() = default;
  explicit KeyframePoints(const MapPoints& points);
  /// @param out  overwritten; keeps its memory. @cost about 5 ns a point
  void unpack(MapPoints& out) const;
  std::size_t size() const { return codes_.size() / 5; }
  /// Whether `unpack` can be asked for: of what was read from a file.
  bool is_sound() const { return codes_.size() % 5 == 0 && step_m_ >= 0.0F && step_m_ < 30.0F; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("step_m", self.step_m_);
    v("codes", self.codes_);
  }

 private:
  float step_m_ = 0.0F;
  std::vector<std::uint16_t> codes_;  // of each point: x, y, normal, variance, variance of the normal
};

}  // namespace phasescan
