// How well poses explain a scan, and the best of a lattice of them.
#include <algorithm>
#include <cmath>

#include "odometry/registration.hpp"

namespace phasescan {

double pose_score(const LocalMap& map, const MapPoints& points, const Pose2& T, std::size_t stride) {
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y);
  const auto reach = static_cast<float>(map.reach_m());
  const float inverse = 1.0F / (reach * reach);
  float sum = 0.0F;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    ++count;
    const float qx = c * points.x[i] - s * points.y[i] + tx, qy = s * points.x[i] + c * points.y[i] + ty;
    const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
    const Surfel* surfel = points.lone(i) ? map.find_lone(qx, qy) : map.find(qx, qy, nx, ny, 0.7F);
    if (!surfel) continue;
    const float dx = qx - surfel->x, dy = qy - surfel->y;
    sum += std::max(0.0F, 1.0F - (dx * dx + dy * dy) * inverse);
  }
  return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0.0;
}

Pose2 search_lattice(const LocalMap& map, const MapPoints& points, const Pose2& centre, const LatticeSearch& lattice,
                     double* best_score) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / std::max<std::size_t>(lattice.points, 1));
  const int turns = static_cast<int>(lattice.half_angle_rad / lattice.step_rad),
            shifts = static_cast<int>(lattice.half_width_m / lattice.step_m);
  Pose2 best = centre;
  double best_value = -1.0, best_value_biased = -1.0;
  for (int a = -turns; a <= turns; ++a) {
    for (int i = -shifts; i <= shifts; ++i) {
      for (int k = -shifts; k <= shifts; ++k) {
        const Pose2 pose{centre.x + i * lattice.step_m, centre.y + k * lattice.step_m,
                         wrap_angle(centre.theta + a * lattice.step_rad)};
        const double value = pose_score(map, points, pose, stride);
        // Among poses that explain as much, the nearer one.
        const double far =
            std::hypot(i, k) / std::max(1, shifts) + std::abs(a) / static_cast<double>(std::max(1, turns));
        const double biased = value - 0.03 * far;
        if (biased > best_value_biased) best_value_biased = biased, best_value = value, best = pose;
      }
    }
  }
  if (best_score) *best_score = best_value;
  return best;
}

}  // namespace phasescan
