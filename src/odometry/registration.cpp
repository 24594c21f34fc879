#include "odometry/registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "odometry/degeneracy.hpp"
#include "odometry/information.hpp"
#include "odometry/point_equations.hpp"

namespace phasescan {
namespace {

// Degenerate directions. Chosen by hand on the recorded corridors and on simulated people who walk with the robot.
// A direction whose variance is so much larger than the other's (their ratio) rests on few surfaces. They must be some
// pieces, of a cell each, and more than a passer-by has where they contradict what is known of the motion.
constexpr double kLopsided = 0.35;
constexpr float kLeastPieces = 3.0F, kPiecesOfPeople = 7.0F, kMostPieces = 12.0F;
constexpr float kShowing = 0.1F, kFits = 4.0F;  // squares: of a cosine that shows something; of standard deviations
// The noise of the normals adds so much on average; what a match claims beyond that along a bare wall is chance, and
// only what stands this many times clear of it is a surface that was seen.
constexpr double kClearOfNormalNoise = 3.0;
constexpr double kContradictsPrior = 9.0, kDifferent = 1.0;  // squared Mahalanobis distances
// The kernel: its width in variances (Geman-McClure), and what the gate adds to a variance, of its square.
constexpr float kKernelVariances = 6.0F, kGateWidening = 0.04F;
constexpr float kAlongM = 0.1F;    // [m] along a surface beyond the gate that a partner may lie
constexpr int kLeastPartners = 5;  // fewer determine nothing
constexpr double kDamping =
    1e-4;  // share of the information: holds the pose where neither surfaces nor prior say anything

// One pass over the points at a pose: normal equations with a Geman-McClure kernel as wide as the gate asks.
struct Pass {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  // What noise of the normals adds to H: it seems to see along bare walls.
  Eigen::Matrix3d normal_noise = Eigen::Matrix3d::Zero();
  int partners = 0;
  double squares = 0.0;
  double kernel_efficiency = 1.0;  // mean share of its weight that a point has left under the wide kernel
};

Eigen::Matrix3d symmetric(const float (&m)[6]) {
  Eigen::Matrix3f M;
  M << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  return M.cast<double>();
}

/// Adds a lone hit, which counts in both directions.
void add_lone(const LocalMap& map, float rx, float ry, float tx, float ty, float variance_of_hit, float gate,
              float widen, PointSums& sums) {
  const Surfel* lone = map.find_lone(rx + tx, ry + ty);
  if (!lone) return;
  const float ex = rx + tx - lone->x, ey = ry + ty - lone->y, d2 = ex * ex + ey * ey;
  if (d2 > gate * gate) return;
  const float variance = variance_of_hit + lone->variance + widen;
  const float kernel = 1.0F / (1.0F + d2 / (kKernelVariances * variance));
  const float w = kernel * kernel / variance;
  sums.H[0] += w;
  sums.H[2] -= w * ry;
  sums.H[3] += w;
  sums.H[4] += w * rx;
  sums.H[5] += w * (rx * rx + ry * ry);
  sums.g[0] += w * ex;
  sums.g[1] += w * ey;
  sums.g[2] += w * (rx * ey - ry * ex);
}

/// @param partners  buffers
Pass linearise(const LocalMap& map, const MapPoints& points, const Pose2& T, double gate_m, double min_cosine,
               PointPartners& partners) {
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y), gate = static_cast<float>(gate_m);
  const auto cosine = static_cast<float>(min_cosine);
  const float widen = kGateWidening * gate * gate;
  PointSums lone;
  std::size_t n = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float rx = c * points.x[i] - s * points.y[i], ry = s * points.x[i] + c * points.y[i];
    if (points.lone(i)) {
      add_lone(map, rx, ry, tx, ty, points.variance[i], gate, widen, lone);
      continue;
    }
    const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
    const Surfel* surfel = map.find(rx + tx, ry + ty, nx, ny, cosine);
    if (!surfel) continue;
    partners.rx[n] = rx, partners.ry[n] = ry;
    partners.nx[n] = surfel->nx, partners.ny[n] = surfel->ny;
    partners.dx[n] = rx + tx - surfel->x, partners.dy[n] = ry + ty - surfel->y;
    partners.variance[n] = points.variance[i] + surfel->variance;
    partners.normal_variance[n] = surfel->normal_variance;
    ++n;
  }
  partners.count = n;
  PointSums sums = sum_point_equations(partners, {gate, gate + kAlongM, widen, kKernelVariances});
  for (int i = 0; i < 6; ++i) sums.H[i] += lone.H[i];
  for (int i = 0; i < 3; ++i) sums.g[i] += lone.g[i];
  Pass pass;
  pass.H = symmetric(sums.H);
  pass.normal_noise = symmetric(sums.normal_noise);
  pass.g = Eigen::Vector3f(sums.g[0], sums.g[1], sums.g[2]).cast<double>();
  pass.squares = static_cast<double>(sums.squares);
  pass.partners = sums.partners;
  if (pass.partners > 0) pass.kernel_efficiency = static_cast<double>(sums.efficiency) / pass.partners;
  return pass;
}

/// The step that the match alone would take, with the sign of a gradient: H^-1 g.
Eigen::Vector3d match_gradient_step(const Pass& pass) {
  Eigen::Matrix3d H = pass.H;
  H.diagonal() *= 1.0 + 1e-6;
  H.diagonal().array() += 1e-9;
  const Eigen::Vector3d step = H.ldlt().solve(pass.g);
  return step.allFinite() ? step : Eigen::Vector3d::Zero();
}

/// What a match does not determine: how many times the noise of the normals is taken out, and a direction without
/// support.
struct Degeneracy {
  double normal_noise_times = 1.0;
  std::optional<Eigen::Vector3d> unobservable;
};

/// What the match sees.
Eigen::Matrix3d seen_by(const Pass& pass, const Degeneracy& degeneracy) {
  Eigen::Matrix3d H = positive_part(pass.H - degeneracy.normal_noise_times * pass.normal_noise);
  if (!degeneracy.unobservable) return H;
  const Eigen::Vector3d along = H * *degeneracy.unobservable;
  const double all = degeneracy.unobservable->dot(along);
  if (all > 0.0) H -= along * along.transpose() / all;
  return positive_part(H);
}

/// The direction of (x, y, theta) that is seen least; empty where the others are not seen much better.
std::optional<Eigen::Vector3d> degenerate_direction(const Pass& pass) {
  const WeakDirection weakest = weakest_direction(seen_by(pass, {}));
  if (weakest.variance_ratio > kLopsided) return std::nullopt;
  return weakest.direction;
}

/// What shows the position in a direction.
struct Evidence {
  float pieces = 0.0F;  ///< of surface that it is spread over, as if all told as much
  int fitting = 0;      ///< pieces that lie where the map has them
};

Evidence evidence_of(const LocalMap& map, const MapPoints& points, const Pose2& T, const Eigen::Vector3d& direction,
                     double gate_m, double min_cosine) {
  const Eigen::Vector3f d = direction.cast<float>();
  const auto c = static_cast<float>(std::cos(T.theta)), s = static_cast<float>(std::sin(T.theta));
  const auto tx = static_cast<float>(T.x), ty = static_cast<float>(T.y), gate = static_cast<float>(gate_m);
  std::vector<float> shown(map.surfels().size(), 0.0F);
  std::vector<char> fits(map.surfels().size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.lone(i)) continue;
    const float rx = c * points.x[i] - s * points.y[i], ry = s * points.x[i] + c * points.y[i];
    const float nx = c * points.nx[i] - s * points.ny[i], ny = s * points.nx[i] + c * points.ny[i];
    const Surfel* surfel = map.find(rx + tx, ry + ty, nx, ny, static_cast<float>(min_cosine));
    if (!surfel) continue;
    const float e = (rx + tx - surfel->x) * surfel->nx + (ry + ty - surfel->y) * surfel->ny;
    if (std::fabs(e) > gate) continue;
    const float across = surfel->nx * d.x() + surfel->ny * d.y() + (rx * surfel->ny - ry * surfel->nx) * d.z();
    const float along = surfel->ny * d.x() - surfel->nx * d.y() + (rx * surfel->nx + ry * surfel->ny) * d.z();
    const float clear =
        across * across - static_cast<float>(kClearOfNormalNoise) * surfel->normal_variance * along * along;
    if (clear <= 0.0F) continue;
    const auto index = static_cast<std::size_t>(surfel - map.surfels().data());
    const float sharp = points.variance[i] + surfel->variance;
    shown[index] += clear / (sharp + kGateWidening * gate * gate);
    if (clear > kShowing && e * e < kFits * sharp) fits[index] = 1;
  }
  Evidence evidence;
  float sum = 0.0F, squares = 0.0F;
  for (const float v : shown) sum += v, squares += v * v;
  for (const char f : fits) evidence.fitting += f;
  if (squares > 0.0F) evidence.pieces = sum * sum / squares;
  return evidence;
}

/// Where a registration is, and its last pass.
struct Descent {
  Registration result;
  Pass pass;
  double gate_m = 0.0;
};

/// Steps until they are small.
void descend(const LocalMap& map, const MapPoints& points, const RegistrationOptions& options,
             const std::optional<PosePrior>& prior, const Degeneracy& degeneracy, PointPartners& partners,
             Descent& at) {
  Registration& result = at.result;
  for (int step_count = 1; step_count <= options.max_iterations; ++step_count) {
    ++result.iterations;
    at.pass = linearise(map, points, result.T_map_base, at.gate_m, options.min_normal_cosine, partners);
    if (at.pass.partners < kLeastPartners) return;
    Eigen::Matrix3d H = at.pass.H;
    Eigen::Vector3d g = at.pass.g;
    if (prior) {
      // Along a corridor the noise of the normals alone would hold the pose where it is: there the prior decides.
      H = seen_by(at.pass, degeneracy);
      g = H * match_gradient_step(at.pass);
      const Eigen::Vector3d off(result.T_map_base.x - prior->T_map_base.x, result.T_map_base.y - prior->T_map_base.y,
                                wrap_angle(result.T_map_base.theta - prior->T_map_base.theta));
      // While the kernel is wide the match weighs less; the prior as well, else it would decide before the match does.
      const Eigen::Matrix3d P = at.pass.kernel_efficiency * prior->information;
      H += P;
      g += P * off;
    }
    const double scale = 0.5 * (H(0, 0) + H(1, 1));
    H(0, 0) += kDamping * scale;
    H(1, 1) += kDamping * scale;
    H(2, 2) += kDamping * H(2, 2) + 1e-9;
    const Eigen::Vector3d step = -H.ldlt().solve(g);
    if (!step.allFinite()) return;
    result.T_map_base.x += step.x();
    result.T_map_base.y += step.y();
    result.T_map_base.theta = wrap_angle(result.T_map_base.theta + step.z());
    const bool small = std::hypot(step.x(), step.y()) < options.stop_m && std::abs(step.z()) < options.stop_rad;
    if (small && at.gate_m <= options.gate_end_m) {
      result.converged = true;
      return;
    }
    // The gate follows the error: far off it stays wide for a while.
    if (std::hypot(step.x(), step.y()) + 2.0 * std::abs(step.z()) < 0.5 * at.gate_m)
      at.gate_m = std::max(options.gate_end_m, 0.6 * at.gate_m);
  }
}

/// Looks at the direction that is seen least. What shows it must stand clear of the noise of the normals, and be more
/// than a few small pieces of surface: somebody who walks along a corridor with the robot, or the roughness of one spot
/// near the sensor. What is known of the motion is the other explanation of such a scan.
void check_degenerate_direction(const LocalMap& map, const MapPoints& points, const RegistrationOptions& options,
                                const std::optional<PosePrior>& prior, Degeneracy& degeneracy, PointPartners& partners,
                                Descent& at) {
  const std::optional<Eigen::Vector3d> u = degenerate_direction(at.pass);
  if (!u) return;
  const auto evidence = [&](const Pose2& T) {
    return evidence_of(map, points, T, *u, at.gate_m, options.min_normal_cosine);
  };
  degeneracy.normal_noise_times = kClearOfNormalNoise;
  const Evidence here = evidence(at.result.T_map_base);
  if (here.pieces < kLeastPieces || (here.pieces < kMostPieces && here.fitting == 0)) degeneracy.unobservable = u;
  if (!prior) return;
  if (!degeneracy.unobservable) {
    const Pose2& T = at.result.T_map_base;
    const double off = u->head<2>().dot(Eigen::Vector2d(T.x - prior->T_map_base.x, T.y - prior->T_map_base.y));
    const double contradiction = off * off * kMatchTrust * u->dot(prior->information * *u);
    if (contradiction > kContradictsPrior && here.pieces < kPiecesOfPeople) {
      degeneracy.unobservable = u;
    } else if (contradiction > (here.pieces < kMostPieces ? kDifferent : kContradictsPrior)) {
      Descent there = at;
      const Degeneracy unobservable{kClearOfNormalNoise, u};
      descend(map, points, options, prior, unobservable, partners, there);
      const int fitting = evidence(there.result.T_map_base).fitting;
      // Between equals what is known of the motion decides.
      if (fitting > here.fitting || (fitting == here.fitting && contradiction > kContradictsPrior)) {
        degeneracy = unobservable;
        at = there;
        return;
      }
    }
  }
  descend(map, points, options, prior, degeneracy, partners, at);
}

}  // namespace

Registration register_points(const LocalMap& map, const MapPoints& points, const Pose2& guess,
                             const RegistrationOptions& options, const std::optional<PosePrior>& prior) {
  Descent at;
  at.result.T_map_base = guess;
  if (map.empty() || points.with_normal == 0) return at.result;
  at.gate_m = options.gate_start_m;
  PointPartners partners;
  partners.reserve(points.size());
  Degeneracy degeneracy;
  descend(map, points, options, prior, degeneracy, partners, at);
  Registration& result = at.result;
  if (at.pass.partners >= kLeastPartners && result.T_map_base.is_finite()) {
    check_degenerate_direction(map, points, options, prior, degeneracy, partners, at);
  }
  const Pass& pass = at.pass;
  result.information = seen_by(pass, degeneracy);
  result.overlap =
      static_cast<double>(pass.partners) / static_cast<double>(std::max<std::size_t>(points.with_normal, 1));
  result.residual_m = pass.partners > 0 ? std::sqrt(pass.squares / pass.partners) : 0.0;
  if (!result.T_map_base.is_finite()) {
    result = {};
    result.T_map_base = guess;
  }
  return result;
}

}  // namespace phasescan
