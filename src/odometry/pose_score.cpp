// How well poses explain a scan, and the best of a lattice of them.
#include <algorithm>
#include <cmath>
#include <vector>

#include "odometry/registration.hpp"

namespace phasescan {
namespace {

constexpr float kSameWay = 0.7F;  // cosine between the normals of a hit and of what it may lie on
constexpr double kPerDistance =
    0.03;  // taken off the score of a pose at the lattice's end: among equals, the nearer one

/// What a hit that falls on (px, py) with that normal is worth, 0..1.
float hit_score(const LocalMap& map, bool lone, float px, float py, float nx, float ny, float inverse_reach2) {
  const Surfel* surfel = lone ? map.find_lone(px, py) : map.find(px, py, nx, ny, kSameWay);
  if (!surfel) return 0.0F;
  const float dx = px - surfel->x, dy = py - surfel->y;
  return std::max(0.0F, 1.0F - (dx * dx + dy * dy) * inverse_reach2);
}

float inverse_reach2_of(const LocalMap& map) {
  const auto reach = static_cast<float>(map.reach_m());
  return 1.0F / (reach * reach);
}

/// Every so many points, turned by one angle.
struct TurnedPoints {
  std::vector<float> x, y, nx, ny;
  std::vector<std::uint8_t> lone;

  void turn(const MapPoints& points, double theta, std::size_t stride) {
    const auto c = static_cast<float>(std::cos(theta)), s = static_cast<float>(std::sin(theta));
    for (auto* v : {&x, &y, &nx, &ny}) v->clear();
    lone.clear();
    for (std::size_t i = 0; i < points.size(); i += stride) {
      x.push_back(c * points.x[i] - s * points.y[i]);
      y.push_back(s * points.x[i] + c * points.y[i]);
      nx.push_back(c * points.nx[i] - s * points.ny[i]);
      ny.push_back(s * points.nx[i] + c * points.ny[i]);
      lone.push_back(points.lone(i));
    }
  }
};

/// The sum of the hits' scores at a translation, or less than `needed` as soon as it cannot be reached any more.
float sum_of_scores(const LocalMap& map, const TurnedPoints& points, float tx, float ty, float inverse_reach2,
                    float needed) {
  float sum = 0.0F;
  auto left = static_cast<float>(points.x.size());
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    sum += hit_score(map, points.lone[i] != 0, points.x[i] + tx, points.y[i] + ty, points.nx[i], points.ny[i],
                     inverse_reach2);
    left -= 1.0F;
    if (sum + left < needed) break;
  }
  return sum;
}

}  // namespace

double pose_score(const LocalMap& map, const MapPoints& points, const Pose2& T, std::size_t stride) {
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y);
  const float inverse_reach2 = inverse_reach2_of(map);
  float sum = 0.0F;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    ++count;
    const float px = c * points.x[i] - s * points.y[i] + tx, py = s * points.x[i] + c * points.y[i] + ty;
    const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
    sum += hit_score(map, points.lone(i), px, py, nx, ny, inverse_reach2);
  }
  return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0.0;
}

Pose2 search_lattice(const LocalMap& map, const MapPoints& points, const Pose2& centre, const LatticeSearch& lattice,
                     double* best_score) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / std::max<std::size_t>(lattice.points, 1));
  const int turns = static_cast<int>(lattice.half_angle_rad / lattice.step_rad),
            shifts = static_cast<int>(lattice.half_width_m / lattice.step_m);
  const float inverse_reach2 = inverse_reach2_of(map);
  Pose2 best = centre;
  double best_value = -1.0, best_value_biased = -1.0;
  TurnedPoints turned;
  // The score of the centre is a bound for all: a pose that cannot beat it is not summed up to the end.
  const double least = pose_score(map, points, centre, stride);
  for (int a = -turns; a <= turns; ++a) {
    const double theta = wrap_angle(centre.theta + a * lattice.step_rad);
    turned.turn(points, theta, stride);
    const auto count = static_cast<double>(turned.x.size());
    for (int i = -shifts; i <= shifts; ++i) {
      for (int k = -shifts; k <= shifts; ++k) {
        const Pose2 pose{centre.x + i * lattice.step_m, centre.y + k * lattice.step_m, theta};
        const double far =
            std::hypot(i, k) / std::max(1, shifts) + std::abs(a) / static_cast<double>(std::max(1, turns));
        // A little less than what would do: sums are of floats.
        const double needed = count * (std::max(least, best_value_biased) + kPerDistance * far) - 1e-3;
        const double value =
            static_cast<double>(sum_of_scores(map, turned, static_cast<float>(pose.x), static_cast<float>(pose.y),
                                              inverse_reach2, static_cast<float>(needed))) /
            std::max(count, 1.0);
        const double biased = value - kPerDistance * far;
        if (biased > best_value_biased) best_value_biased = biased, best_value = value, best = pose;
      }
    }
  }
  if (best_score) *best_score = best_value;
  return best;
}

}  // namespace phasescan
