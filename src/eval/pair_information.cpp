#include "eval/pair_information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "odometry/information.hpp"
#include "scan/surface.hpp"

namespace phasescan {
namespace {

using Eigen::Vector2d;

// What such sensors are sold with. The noise read off one scan can be far less: the errors of neighbouring beams go
// together, those of two scans do not.
constexpr double kLeastSigma_m = 0.01;
constexpr double kFacing = 0.9;           // cosine between the normals of hits on one surface
constexpr double kNear_m = 0.1;           // beside the gap between the other's hits
constexpr double kFlat_m = 0.02;          // hits of one flat piece lie this near to its line, or within three sigma
constexpr double kGap_m = 0.3;            // and this near to each other, or within three gaps between beams
constexpr double kNormalVariance = 0.05;  // [rad^2] of a piece whose direction is known

/// A hit on a flat piece of surface.
struct FlatHit {
  Vector2d point;
  Vector2d normal = Vector2d::Zero();  ///< of the whole piece, towards the sensor; 0 where it is not known
  double normal_variance = 0.0;        ///< [rad^2]
  double variance = 0.0;               ///< of the range along the normal [m^2]
  double length = 0.0;                 ///< of surface that the beam stands for [m]

  bool has_normal() const { return !normal.isZero(); }
  /// Variance times length: the inverse of the density of information along the surface.
  double variance_length() const { return variance * length; }
};

/// The line through hits [first, last) by total least squares.
struct Line {
  Vector2d centre = Vector2d::Zero(), normal = Vector2d::Zero();
  double spread = 0.0;  ///< sum of the squared distances along the line [m^2]
};

Line fit_line(const std::vector<FlatHit>& hits, std::size_t first, std::size_t last) {
  Line line;
  const auto n = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) line.centre += hits[i].point / n;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const Vector2d off = hits[i].point - line.centre;
    scatter += off * off.transpose();
  }
  const double along = 0.5 * std::atan2(2.0 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  const Vector2d direction(std::cos(along), std::sin(along));
  line.normal = {-direction.y(), direction.x()};
  line.spread = direction.dot(scatter * direction);
  return line;
}

double sigma_along(const Vector2d& point, const Vector2d& normal, const RangeNoise& noise) {
  const double range = point.norm();
  const double sigma = std::max(kLeastSigma_m, static_cast<double>(noise.sigma(static_cast<float>(range))));
  return sigma * std::abs(normal.dot(point)) / std::max(range, 1e-6);
}

/// Cuts the hits, in order of direction, into flat pieces. A wall's direction is then known from all of its hits: the
/// normals of single ones, noisy as they are, would pretend to see along it.
std::vector<FlatHit> flat_hits(const Scan& scan) {
  SurfaceWorkspace work;
  SurfacePoints surface;
  find_surface(scan, {}, work, surface);
  std::vector<FlatHit> hits(surface.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    hits[i].point = {static_cast<double>(surface[i].x), static_cast<double>(surface[i].y)};
  const auto joins = [&](std::size_t i, const Line& line) {
    const double gap = (hits[i].point - hits[i - 1].point).norm();
    const double reach = std::max(kGap_m, 3.0 * surface.spacing * hits[i].point.norm());
    const double off = std::abs(line.normal.dot(hits[i].point - line.centre));
    return gap < reach && off < std::max(kFlat_m, 3.0 * sigma_along(hits[i].point, line.normal, surface.noise));
  };
  for (std::size_t first = 0; first < hits.size();) {
    std::size_t last = std::min(first + 2, hits.size());
    Line line = fit_line(hits, first, last);
    while (last < hits.size() && joins(last, line)) line = fit_line(hits, first, ++last);
    double mean_variance = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double sigma = sigma_along(hits[i].point, line.normal, surface.noise);
      mean_variance += sigma * sigma / static_cast<double>(last - first);
    }
    const double normal_variance = mean_variance / std::max(line.spread, 1e-12);
    if (last - first >= 3 && normal_variance < kNormalVariance) {
      for (std::size_t i = first; i < last; ++i) {
        FlatHit& hit = hits[i];
        const double sigma = sigma_along(hit.point, line.normal, surface.noise), range = hit.point.norm();
        hit.normal = line.normal.dot(hit.point) > 0.0 ? Vector2d(-line.normal) : line.normal;
        hit.normal_variance = normal_variance;
        hit.variance = sigma * sigma;
        hit.length = surface.spacing * range * range / std::max(std::abs(line.normal.dot(hit.point)), 1e-3 * range);
      }
    }
    first = last;
  }
  return hits;
}

/// The other scan's nearest hit on the same surface, if it has one there.
const FlatHit* partner(const std::vector<FlatHit>& other, const Vector2d& at, const Vector2d& facing) {
  const FlatHit* found = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const FlatHit& hit : other) {
    const double distance = (hit.point - at).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      found = &hit;
    }
  }
  if (found == nullptr || !found->has_normal() || found->normal.dot(facing) < kFacing) return nullptr;
  return nearest < (kNear_m + found->length) * (kNear_m + found->length) ? found : nullptr;
}

/// Adds what the hits of one scan say. The arm of a hit is taken from the scan's origin, in the reference frame.
void add_information(const std::vector<FlatHit>& own, const std::vector<FlatHit>& other, const Pose2& T_other_own,
                     const Pose2& T_ref_own, const Vector2d& scan_origin, Eigen::Matrix3d& information) {
  for (const FlatHit& hit : own) {
    if (!hit.has_normal()) continue;
    const FlatHit* const of_other = partner(other, T_other_own * hit.point, T_other_own.rotation() * hit.normal);
    if (of_other == nullptr) continue;
    // Both scans know the place of the surface along its normal; for the pose they act in series. Each stretch of
    // surface is met twice, once from either scan: hence the half.
    const double weight = 0.5 * hit.length / (hit.variance_length() + of_other->variance_length());
    const Vector2d n = T_ref_own.rotation() * hit.normal, arm = T_ref_own * hit.point - scan_origin;
    const auto gradient = [&](const Vector2d& direction) {
      return Eigen::Vector3d(direction.x(), direction.y(), -direction.x() * arm.y() + direction.y() * arm.x());
    };
    const Eigen::Vector3d across = gradient(n), along = gradient({-n.y(), n.x()});
    // A noisy normal seems to say something of the direction along the surface: that much is taken off again.
    information += weight * (across * across.transpose() - hit.normal_variance * along * along.transpose());
  }
}

}  // namespace

Eigen::Matrix3d surface_information(const Scan& reference, const Scan& scan, const Pose2& T_ref_scan) {
  const std::vector<FlatHit> of_ref = flat_hits(reference), of_scan = flat_hits(scan);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  add_information(of_scan, of_ref, T_ref_scan, T_ref_scan, T_ref_scan.translation(), information);
  add_information(of_ref, of_scan, T_ref_scan.inverse(), {}, T_ref_scan.translation(), information);
  return positive_part(information);
}

}  // namespace phasescan
