#include "odometry/resolve_degenerate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

// The poses that are tried: so many to either side, so far apart [m]; and so many of the scan's points.
constexpr int kSteps = 20;
constexpr std::size_t kCount = 2 * kSteps + 1;
constexpr double kStepM = 0.015;
constexpr std::size_t kPoints = 250;
// The likelihood of a hit. Relief of walls and edges that a beam meets by half seem to move along with the sensor: only
// what is deeper than this tells [m], and the hits of one niche are not independent of each other.
constexpr float kReliefM = 0.04F;
constexpr double kIndependentShare = 0.015;  // of a hit's log-likelihood that counts
constexpr float kOutlier = 0.05F;            // likelihood of a hit that lies on nothing
constexpr float kEndM = 0.1F;                // [m] past a wall's last known piece
constexpr float kFacesCosine = 0.75F;        // between normals of a hit and a surface that face the same way

double offset_of(std::size_t k) {
  return (static_cast<int>(k) - kSteps) * kStepM;
}

using Profile = std::array<double, kCount>;

/// Where the points are at one of the poses.
struct Placement {
  float c, s, x, y;
};

/// log(kOutlier + (1 - kOutlier) exp(-x)), from a table: thousands are asked for per scan. Off by 5e-5 at most.
class LogLikelihood {
 public:
  LogLikelihood() {
    for (std::size_t k = 0; k < values_.size(); ++k)
      values_[k] = std::log(kOutlier + (1.0F - kOutlier) * std::exp(-static_cast<float>(k) * kStep));
  }
  float operator()(float x) const {
    const float at = x * (1.0F / kStep);
    if (!(at < kLast)) return values_.back();
    const auto k = static_cast<std::size_t>(at);
    return values_[k] + (at - static_cast<float>(k)) * (values_[k + 1] - values_[k]);
  }

 private:
  static constexpr float kStep = 0.02F, kLast = 800.0F;  // beyond x = 16 nothing but outliers are left
  std::array<float, 801> values_{};
};

/// Logarithm of the likelihood of a hit at a pose; empty where the map knows nothing of the place.
std::optional<float> fit_of(const LocalMap& map, const MapPoints& points, std::size_t i, const Placement& at) {
  static const LogLikelihood kLogLikelihood;
  const float px = at.c * points.x[i] - at.s * points.y[i] + at.x, py = at.s * points.x[i] + at.c * points.y[i] + at.y;
  const float nx = at.c * points.nx[i] - at.s * points.ny[i], ny = at.s * points.nx[i] + at.c * points.ny[i];
  const Surfel* surfel = map.find(px, py, nx, ny, -1.1F);
  if (!surfel) return std::nullopt;
  const float dx = px - surfel->x, dy = py - surfel->y;
  const float across = dx * surfel->nx + dy * surfel->ny, along = dy * surfel->nx - dx * surfel->ny;
  if (surfel->nx * nx + surfel->ny * ny < kFacesCosine) return kLogLikelihood(std::numeric_limits<float>::infinity());
  if (std::fabs(along) > kEndM) return std::nullopt;
  const float variance = points.variance[i] + surfel->variance + kReliefM * kReliefM;
  return kLogLikelihood(0.5F * across * across / variance);
}

/// Adds what a hit says of each pose. Where nothing is known it is taken to fit as it does elsewhere.
void add_hit(const LocalMap& map, const MapPoints& points, std::size_t i,
             const std::array<Placement, kCount>& placements, double share, Profile& profile) {
  std::array<std::optional<float>, kCount> fit;
  float sum = 0.0F;
  int known = 0;
  for (std::size_t k = 0; k < kCount; ++k) {
    fit[k] = fit_of(map, points, i, placements[k]);
    if (fit[k]) sum += *fit[k], ++known;
  }
  if (known == 0) return;
  const float usual = sum / static_cast<float>(known);
  for (std::size_t k = 0; k < kCount; ++k) profile[k] += share * static_cast<double>(fit[k].value_or(usual));
}

struct WeightedMoments {
  double mean = 0.0, variance = 0.0;
};

WeightedMoments moments_of(const Profile& weight) {
  const double best = *std::max_element(weight.begin(), weight.end());
  double sum = 0.0, mean = 0.0, square = 0.0;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double w = std::exp(weight[k] - best), offset = offset_of(k);
    sum += w, mean += w * offset, square += w * offset * offset;
  }
  mean /= sum;
  // Between two poses that were tried nothing is told apart.
  return {mean, std::max(square / sum - mean * mean, kStepM * kStepM / 12.0)};
}

}  // namespace

DirectionFit fit_along(const LocalMap& map, const MapPoints& points, const Pose2& T_map_base,
                       const Eigen::Vector3d& direction, const PosePrior& prior) {
  const Eigen::Vector2d to_prior(prior.T_map_base.x - T_map_base.x, prior.T_map_base.y - T_map_base.y);
  const double expected = direction.head<2>().dot(to_prior);
  const double known = kMatchTrust * direction.dot(prior.information * direction);
  Profile prior_weight;
  std::array<Placement, kCount> placements;
  for (std::size_t k = 0; k < kCount; ++k) {
    const double offset = offset_of(k), off = offset - expected;
    const double theta = T_map_base.theta + offset * direction.z();
    placements[k] = {static_cast<float>(std::cos(theta)), static_cast<float>(std::sin(theta)),
                     static_cast<float>(T_map_base.x + offset * direction.x()),
                     static_cast<float>(T_map_base.y + offset * direction.y())};
    prior_weight[k] = -0.5 * known * off * off;
  }
  Profile weight = prior_weight;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kPoints);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (!points.lone(i)) add_hit(map, points, i, placements, kIndependentShare * static_cast<double>(stride), weight);
  }
  const WeightedMoments with = moments_of(weight), without = moments_of(prior_weight);
  return {with.mean, std::max(0.0, 1.0 / with.variance - 1.0 / without.variance) / kMatchTrust};
}

void resolve_degenerate_direction(const LocalMap& map, const MapPoints& points, const PosePrior& prior,
                                  Registration& found) {
  if (determines_position(kMatchTrust * found.information)) return;
  const Eigen::Vector3d u = weakest_direction(kMatchTrust * found.information).direction;
  const DirectionFit fit = fit_along(map, points, found.T_map_base, u, prior);
  Pose2& T = found.T_map_base;
  T = {T.x + fit.offset_m * u.x(), T.y + fit.offset_m * u.y(), wrap_angle(T.theta + fit.offset_m * u.z())};
  const Eigen::Vector3d along(u.x(), u.y(), 0.0);
  found.information += fit.information * along * along.transpose();
}

}  // namespace phasescan
