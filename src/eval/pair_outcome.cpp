#include "eval/pair_outcome.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "scan/points.hpp"

namespace phasescan {
namespace {

/// Share of the points p that lie near one of the points q; gates[i] belongs to q_i, squared [m^2].
double share_near(const ScanPoints& p, const Pose2& T_q_p, const ScanPoints& q,
                  const std::vector<float>& squared_gates) {
  std::size_t near = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2f at = (T_q_p * Eigen::Vector2d(p.x[i], p.y[i])).cast<float>();
    bool found = false;
    for (std::size_t k = 0; k < q.size() && !found; ++k) {
      const float dx = q.x[k] - at.x(), dy = q.y[k] - at.y();
      found = dx * dx + dy * dy < squared_gates[k];
    }
    near += found;
  }
  return static_cast<double>(near) / static_cast<double>(p.size());
}

std::vector<float> squared_gates(const ScanPoints& points, const Scan& scan) {
  const double n = static_cast<double>(scan.size());
  const double step = scan.angles.empty() ? std::abs(scan.geometry.angle_increment) : kTwoPi / n;
  std::vector<float> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double gate = 0.1 + 1.5 * step * static_cast<double>(points.range[i]);
    out[i] = static_cast<float>(gate * gate);
  }
  return out;
}

/// What the information of the ranges says of an error: see PairOutcome.
void judge_by_information(const Eigen::Matrix3d& information, const Eigen::Vector3d& e, PairOutcome& out) {
  out.efficiency = e.dot(information * e);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(information);
  Eigen::Vector2d weakest(1.0, 0.0);
  if (lu.isInvertible()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(lu.inverse().topLeftCorner<2, 2>().eval());
    out.weak_sigma_m = std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
    weakest = axes.eigenvectors().col(1);
  } else {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information.topLeftCorner<2, 2>().eval());
    out.weak_sigma_m = std::numeric_limits<double>::infinity();
    weakest = axes.eigenvectors().col(0);
  }
  out.error_across_m = std::abs(e.x() * -weakest.y() + e.y() * weakest.x());
}

}  // namespace

double PairOutcome::translation_error() const {
  return std::hypot(error_x, error_y);
}

PairOutcome judge(const ScanPair& pair, const MatchResult& result, std::size_t method, double overlap,
                  const std::optional<Eigen::Matrix3d>& information, InformationSource source) {
  PairOutcome out;
  out.id = pair.id;
  out.dataset = pair.dataset;
  out.cls = pair.cls;
  out.method = method;
  out.usable = result.usable;
  out.confidence = result.confidence;
  out.features = result.diagnostics.features;
  out.ambiguous = result.ambiguous;
  out.rotation_source = result.diagnostics.rotation_source;
  out.ms = result.diagnostics.ms;
  if (!pair.truth) return out;
  out.has_truth = true;
  out.overlap = overlap;
  out.error_x = result.T_ref_scan.x - pair.truth->x;
  out.error_y = result.T_ref_scan.y - pair.truth->y;
  out.error_theta = wrap_angle(result.T_ref_scan.theta - pair.truth->theta);
  out.right =
      out.translation_error() < kSuccessTranslation_m && std::abs(out.error_theta) < deg_to_rad(kSuccessRotation_deg);
  const Eigen::Vector3d e(out.error_x, out.error_y, out.error_theta);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(result.covariance);
  if (lu.isInvertible()) out.nees = e.dot(lu.solve(e));
  if (information) judge_by_information(*information, e, out);
  if (source == InformationSource::kSurfaces) out.efficiency = std::numeric_limits<double>::quiet_NaN();
  return out;
}

double scan_overlap(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan) {
  ScanPoints a, b;
  scan_to_points(reference, a);
  scan_to_points(scan, b);
  if (a.size() == 0 || b.size() == 0) return 0.0;
  return std::min(share_near(b, T_ref_scan, a, squared_gates(a, reference)),
                  share_near(a, T_ref_scan.inverse(), b, squared_gates(b, scan)));
}

}  // namespace phasescan
