/// Normal equations of points and the surface elements they lie on, by vector code.
#pragma once

#include <cstddef>
#include <vector>

namespace phasescan {

/// Points with a partner each, structure of arrays, padded to whole vectors.
struct PointPartners {
  static constexpr std::size_t kPadding = 16;
  std::vector<float> rx, ry;           ///< the point, turned but not moved [m]
  std::vector<float> nx, ny;           ///< normal of the partner
  std::vector<float> dx, dy;           ///< from the partner to the point [m]
  std::vector<float> variance;         ///< of point and partner across the surface [m^2]
  std::vector<float> normal_variance;  ///< of the partner's normal [rad^2]
  std::size_t count = 0;

  /// Room for so many points.
  void reserve(std::size_t points) {
    const std::size_t padded = (points + kPadding - 1) / kPadding * kPadding;
    for (auto* v : {&rx, &ry, &nx, &ny, &dx, &dy, &variance, &normal_variance}) v->resize(padded);
    count = 0;
  }
};

/// Which partners count, and how much.
struct PointGate {
  float across_m = 0.0F, along_m = 0.0F;  ///< farther from the surface, or along it, is no partner
  float widen = 0.0F;                     ///< added to each variance [m^2]
  float kernel_variances = 6.0F;          ///< width of the Geman-McClure kernel
};

/// Sums over the partners within the gate; matrices as (xx, xy, xt, yy, yt, tt).
struct PointSums {
  float H[6] = {}, g[3] = {};
  float normal_noise[6] = {};  ///< what noise of the normals adds to H
  float squares = 0.0F;        ///< of the distances across
  float efficiency = 0.0F;     ///< shares of the weights that the widening leaves
  int partners = 0;
};

/// @cost about 2 ns a point
PointSums sum_point_equations(const PointPartners& partners, const PointGate& gate);

}  // namespace phasescan
