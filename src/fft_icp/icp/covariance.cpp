#include "fft_icp/icp/covariance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace phasescan {
namespace {

constexpr int kBeamsAside = 5;        // beams to either side
constexpr float kReach = 0.3F;        // [m] around the point
constexpr double kLeastSigma = 0.01;  // [m]
constexpr double kPlainInflation = 4.0;

/// Unit normal of the surface at a reference point, from the points of neighbouring beams.
std::optional<Eigen::Vector2d> surface_normal(const ScanPoints& points, int at) {
  const int n = static_cast<int>(points.size());
  const auto i = static_cast<std::size_t>(at);
  double count = 0.0, sx = 0.0, sy = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (int k = std::max(0, at - kBeamsAside); k <= std::min(n - 1, at + kBeamsAside); ++k) {
    const auto j = static_cast<std::size_t>(k);
    const float dx = points.x[j] - points.x[i], dy = points.y[j] - points.y[i];
    if (dx * dx + dy * dy > kReach * kReach) continue;
    const auto x = static_cast<double>(dx), y = static_cast<double>(dy);
    count += 1.0;
    sx += x;
    sy += y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  if (count < 3.0) return std::nullopt;
  xx -= sx * sx / count;
  xy -= sx * sy / count;
  yy -= sy * sy / count;
  if (!(xx + yy > 0.0)) return std::nullopt;
  const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
  return Eigen::Vector2d(-std::sin(along), std::cos(along));
}

}  // namespace

Eigen::Matrix3d covariance_from_information(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information);
  const Eigen::Vector3d variances =
      solver.eigenvalues().unaryExpr([](double v) { return v > 1.0 / kUnknownVariance ? 1.0 / v : kUnknownVariance; });
  const Eigen::Matrix3d covariance = solver.eigenvectors() * variances.asDiagonal() * solver.eigenvectors().transpose();
  return covariance.selfadjointView<Eigen::Lower>();  // to the last bit
}

Eigen::Matrix3d surface_covariance(const ScanPoints& reference, const ScanPoints& scan, const Pose2& T_ref_scan,
                                   std::span<const PointPair> pairs) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const double c = std::cos(T_ref_scan.theta), s = std::sin(T_ref_scan.theta);
  double squared = 0.0, count = 0.0;
  for (const PointPair& pair : pairs) {
    const std::optional<Eigen::Vector2d> normal = surface_normal(reference, pair.reference);
    if (!normal) continue;
    const auto i = static_cast<std::size_t>(pair.scan), m = static_cast<std::size_t>(pair.reference);
    const auto px = static_cast<double>(scan.x[i]), py = static_cast<double>(scan.y[i]);
    const double rx = c * px - s * py, ry = s * px + c * py;
    const double across = normal->x() * (rx + T_ref_scan.x - static_cast<double>(reference.x[m])) +
                          normal->y() * (ry + T_ref_scan.y - static_cast<double>(reference.y[m]));
    const Eigen::Vector3d j(normal->x(), normal->y(), -normal->x() * ry + normal->y() * rx);
    information += j * j.transpose();
    squared += across * across;
    count += 1.0;
  }
  if (count < 3.0) return Eigen::Matrix3d::Identity() * kUnknownVariance;
  const double variance = std::max(squared / count, kLeastSigma * kLeastSigma);
  return covariance_from_information(information / (kPlainInflation * variance));
}

}  // namespace phasescan
