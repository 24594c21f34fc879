#include "fft_icp/icp/icp.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {

Pose2 rigid_motion(const Eigen::Matrix2d& cross_covariance, const Eigen::Vector2d& mean_s,
                   const Eigen::Vector2d& mean_m) {
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(cross_covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix2d& u = svd.matrixU();
  const Eigen::Matrix2d& v = svd.matrixV();
  Eigen::Matrix2d guard = Eigen::Matrix2d::Identity();
  guard(1, 1) = (v * u.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix2d r = v * guard * u.transpose();
  const Eigen::Vector2d t = mean_m - r * mean_s;
  return {t.x(), t.y(), std::atan2(r(1, 0), r(0, 0))};
}

void Icp::find_pairs(const PointIndex& reference, double gate, std::size_t step) {
  const auto limit = static_cast<float>(gate);
  pairs_.clear();
  for (std::size_t i = 0; i < x_.size(); i += step) {
    Warm& warm = warm_[i];
    const float moved_x = x_[i] - warm.x, moved_y = y_[i] - warm.y;
    if (!(moved_x * moved_x + moved_y * moved_y < warm.safe_squared)) {
      const NearestPair found = reference.nearest(x_[i], y_[i]);
      const float safe = 0.5F * (found.second_distance - found.distance);
      warm = {x_[i], y_[i], safe * safe, found.index};
    }
    if (warm.index < 0) {  // so far off that no distance is finite
      squared_[i] = std::numeric_limits<float>::infinity();
      continue;
    }
    const float dx = reference.x(warm.index) - x_[i], dy = reference.y(warm.index) - y_[i];
    const float squared = dx * dx + dy * dy;
    squared_[i] = squared;
    if (squared <= limit * limit) pairs_.push_back({static_cast<int>(i), warm.index});
  }
  if (options_.trim < 1.0 && pairs_.size() > 2) trim_pairs();
}

void Icp::trim_pairs() {
  const auto keep =
      std::max<std::size_t>(2, static_cast<std::size_t>(options_.trim * static_cast<double>(pairs_.size())));
  // Ties are broken by the beam, so that the kept set does not depend on the order of the selection.
  std::nth_element(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(keep) - 1, pairs_.end(),
                   [&](const PointPair& a, const PointPair& b) {
                     const float da = squared_[static_cast<std::size_t>(a.scan)],
                                 db = squared_[static_cast<std::size_t>(b.scan)];
                     return da != db ? da < db : a.scan < b.scan;
                   });
  pairs_.resize(keep);
}

IcpResult Icp::align(const PointIndex& reference, const ScanPoints& scan, const Pose2& guess, bool guessed) {
  IcpResult result;
  result.T_ref_scan = guess;
  const std::size_t n = scan.size();
  if (n == 0 || reference.size() == 0) return result;

  constexpr double kNoGate = 1e18;
  const double gate_end = options_.gate_m > 0.0 ? options_.gate_m : kNoGate;
  double gate = std::max(gate_end, guessed ? options_.gate_guess_m : options_.gate_start_m);
  const double shrink = guessed ? options_.gate_shrink : options_.gate_start_shrink;
  x_.resize(n);
  y_.resize(n);
  warm_.assign(n, Warm{0.0F, 0.0F, -1.0F, 0});
  squared_.resize(n);
  pairs_.reserve(n);
  // On the way a fair sample of the points is enough.
  const auto sample = static_cast<std::size_t>(options_.coarse_points);
  const std::size_t coarse_step = sample > 0 ? std::max<std::size_t>(1, n / sample) : 1;
  const double turn_tolerance = deg_to_rad(options_.tolerance_deg);

  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    const Pose2 pose = result.T_ref_scan;
    const auto c = static_cast<float>(std::cos(pose.theta)), s = static_cast<float>(std::sin(pose.theta));
    const auto tx = static_cast<float>(pose.x), ty = static_cast<float>(pose.y);
    for (std::size_t i = 0; i < n; ++i) {
      x_[i] = c * scan.x[i] - s * scan.y[i] + tx;
      y_[i] = s * scan.x[i] + c * scan.y[i] + ty;
    }
    find_pairs(reference, gate, gate > gate_end ? coarse_step : 1);
    result.iterations = iteration + 1;
    result.pairs = static_cast<int>(pairs_.size());
    if (pairs_.size() < 2) break;

    const double weight = 1.0 / static_cast<double>(pairs_.size());
    Eigen::Vector2d mean_s = Eigen::Vector2d::Zero(), mean_m = Eigen::Vector2d::Zero();
    Eigen::Matrix2d cross = Eigen::Matrix2d::Zero();
    double squared = 0.0;
    for (const PointPair& pair : pairs_) {
      const Eigen::Vector2d p(x_[static_cast<std::size_t>(pair.scan)], y_[static_cast<std::size_t>(pair.scan)]);
      const Eigen::Vector2d m(reference.x(pair.reference), reference.y(pair.reference));
      mean_s += p;
      mean_m += m;
      cross += p * m.transpose();
      squared += static_cast<double>(squared_[static_cast<std::size_t>(pair.scan)]);
    }
    mean_s *= weight;
    mean_m *= weight;
    cross = cross * weight - mean_s * mean_m.transpose();
    result.rms_m = std::sqrt(squared * weight);

    // R = R_icp R1, T = R_icp T1 + T_icp ([Jiang19] Sec. 4).
    const Pose2 step = rigid_motion(cross, mean_s, mean_m);
    result.T_ref_scan = step * pose;
    const bool at_rest =
        std::hypot(result.T_ref_scan.x - pose.x, result.T_ref_scan.y - pose.y) <= options_.tolerance_m &&
        std::abs(step.theta) <= turn_tolerance;
    if (gate <= gate_end && at_rest) {
      result.converged = true;
      break;
    }
    gate = std::max(gate_end, gate * shrink);
  }
  result.overlap = static_cast<double>(result.pairs) / static_cast<double>(n);
  return result;
}

}  // namespace phasescan
