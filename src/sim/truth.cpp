#include "sim/truth.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace phasescan::sim {
namespace {

using Eigen::Vector2d;

/// A noise-free hit of one scan on surface that the other pose sees too. World frame.
struct MutualHit {
  Vector2d point;
  Vector2d normal;
  bool resolved = false;                                ///< a neighbouring beam meets the same flat piece
  double range = 0.0, incidence_cos = 0.0;              ///< from its own pose
  double other_range = 0.0, other_incidence_cos = 0.0;  ///< from the other
};

struct Visible {
  std::size_t hits = 0;
  std::vector<MutualHit> mutual;
};

bool in_view(const LidarOptions& lidar, const Pose2& pose, const Vector2d& point) {
  if (lidar.fov_deg >= 360.0) return true;
  const double first = deg_to_rad(lidar.angle_min_deg), step = lidar.angle_increment();
  const double bearing = std::atan2(point.y() - pose.y, point.x() - pose.x) - pose.theta;
  const double turn = wrap_positive(step > 0.0 ? bearing - first : first - bearing);
  return turn <= std::abs(step) * (lidar.beams - 1) + 1e-9;
}

/// What the other pose sees where this hit lies; nothing if something else answers there.
std::optional<RayHit> seen_from(const Surroundings& around, const LidarOptions& lidar, const Pose2& pose,
                                const Vector2d& point, const Vector2d& normal) {
  constexpr double kSame_m = 0.03, kSameCos = 0.9;
  if (!in_view(lidar, pose, point)) return {};
  const Vector2d to = point - pose.translation();
  const double distance = to.norm();
  if (distance < lidar.range_min_m || distance > lidar.range_max_m) return {};
  const RayHit hit = cast_beam(around, lidar, pose.translation(), to / distance);
  if (!hit.found() || std::abs(hit.range - distance) > kSame_m || hit.normal.dot(normal) < kSameCos) return {};
  return hit;
}

/// True where both points lie on one flat piece of surface: what a single beam meets says nothing of where the surface
/// runs.
bool same_piece(const Vector2d& p, const RayHit& at_p, const Vector2d& q, const RayHit& at_q) {
  constexpr double kFlat_m = 0.02, kFlatCos = 0.9;
  return at_p.found() && at_q.found() && at_p.normal.dot(at_q.normal) > kFlatCos &&
         std::abs(at_p.normal.dot(q - p)) < kFlat_m;
}

Visible look(const Surroundings& own, const Pose2& pose, const Surroundings& other, const Pose2& other_pose,
             const LidarOptions& lidar) {
  const auto count = static_cast<std::size_t>(lidar.beams);
  const double first = pose.theta + deg_to_rad(lidar.angle_min_deg), step = lidar.angle_increment();
  std::vector<RayHit> hits(count);
  std::vector<Vector2d> points(count, Vector2d::Zero());
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = first + static_cast<double>(i) * step;
    const Vector2d direction(std::cos(angle), std::sin(angle));
    hits[i] = cast_beam(own, lidar, pose.translation(), direction);
    if (hits[i].found()) points[i] = pose.translation() + hits[i].range * direction;
  }
  Visible out;
  for (std::size_t i = 0; i < count; ++i) {
    if (!hits[i].found() || hits[i].range < lidar.range_min_m) continue;
    ++out.hits;
    const auto back = seen_from(other, lidar, other_pose, points[i], hits[i].normal);
    if (!back) continue;
    const bool resolved = (i > 0 && same_piece(points[i], hits[i], points[i - 1], hits[i - 1])) ||
                          (i + 1 < count && same_piece(points[i], hits[i], points[i + 1], hits[i + 1]));
    out.mutual.push_back(
        {points[i], hits[i].normal, resolved, hits[i].range, hits[i].cos_incidence, back->range, back->cos_incidence});
  }
  return out;
}

/// Share of the beams on matt surface that give a range, averaged over good and bad surface.
double answer_probability(const LidarOptions& lidar, double range, double cos_incidence) {
  const double incidence = std::acos(std::clamp(cos_incidence, 0.0, 1.0)), grazing = deg_to_rad(lidar.grazing_deg);
  const double missed = incidence > grazing ? (incidence - grazing) / (0.5 * kPi - grazing) : 0.0;
  // Samples that are not in step with the turn leave beams empty where there are fewer of them than beams.
  const double beams_a_turn = kTwoPi / std::abs(lidar.angle_increment());
  const double sampled = lidar.effects.sample_rate_hz > 0.0
                             ? std::min(1.0, lidar.effects.sample_rate_hz / lidar.rate_hz / beams_a_turn)
                             : 1.0;
  constexpr double kMeanLossOfBadPatch = 0.5;
  return (1.0 - dropout_share(lidar, range)) * (1.0 - kMeanLossOfBadPatch * lidar.effects.patch_share) * sampled *
         (1.0 - missed);
}

/// Variance times length of surface a beam stands for [m^3]: the inverse of the information density along the surface.
/// A range is off along the beam, a direction across it; what counts is how far the hit is off along the normal.
double variance_length(const LidarOptions& lidar, double range, double cos_incidence) {
  // Rounding to the sensor's steps is an error as large in all of a step.
  const double rounding = lidar.resolution_m / std::sqrt(12.0);
  const double sigma = std::hypot(lidar.sigma(range), rounding), bearing_sigma = lidar.bearing_sigma();
  const double answers = std::max(1e-6, answer_probability(lidar, range, cos_incidence));
  const double length = range * std::abs(lidar.angle_increment());
  if (bearing_sigma <= 0.0) return length * sigma * sigma * cos_incidence / answers;
  const double cosine = std::max(1e-3, cos_incidence), across = range * bearing_sigma;
  return length / cosine * (sigma * sigma * cosine * cosine + across * across * (1.0 - cosine * cosine)) / answers;
}

/// The information that is left where each scan as a whole is turned by an angle of this variance [rad^2]: the scan's
/// turn is an error of theta, the reference's one of the whole pose about the reference's sensor. By the matrix
/// inversion lemma, so that directions without information stay without.
Eigen::Matrix3d with_turned_scans(const Eigen::Matrix3d& information, const Pose2& T_ref_scan, double variance) {
  if (variance <= 0.0) return information;
  Eigen::Matrix<double, 3, 2> gradients;
  gradients.col(0) = Eigen::Vector3d(0.0, 0.0, 1.0);
  gradients.col(1) = Eigen::Vector3d(-T_ref_scan.y, T_ref_scan.x, 1.0);
  const Eigen::Matrix<double, 3, 2> weighted = information * gradients;
  const Eigen::Matrix2d inner = Eigen::Matrix2d::Identity() / variance + gradients.transpose() * weighted;
  return information - weighted * inner.inverse() * weighted.transpose();
}

}  // namespace

Overlap pair_overlap(const Surroundings& around_ref, const Surroundings& around_scan, const LidarOptions& lidar,
                     const Pose2& T_world_ref, const Pose2& T_world_scan) {
  const auto share = [](const Visible& v) {
    return v.hits ? static_cast<double>(v.mutual.size()) / static_cast<double>(v.hits) : 0.0;
  };
  return {share(look(around_scan, T_world_scan, around_ref, T_world_ref, lidar)),
          share(look(around_ref, T_world_ref, around_scan, T_world_scan, lidar))};
}

Eigen::Matrix3d pair_information(const Surroundings& around_ref, const Surroundings& around_scan,
                                 const LidarOptions& lidar, const Pose2& T_world_ref, const Pose2& T_world_scan) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const Eigen::Matrix2d R_ref_world = T_world_ref.rotation().transpose();
  const double step = std::abs(lidar.angle_increment());
  for (const bool from_scan : {true, false}) {
    const Visible visible = from_scan ? look(around_scan, T_world_scan, around_ref, T_world_ref, lidar)
                                      : look(around_ref, T_world_ref, around_scan, T_world_scan, lidar);
    for (const MutualHit& hit : visible.mutual) {
      if (!hit.resolved) continue;
      const double length = hit.range * step / std::max(1e-3, hit.incidence_cos);
      const double weight = 0.5 * length /
                            (variance_length(lidar, hit.range, hit.incidence_cos) +
                             variance_length(lidar, hit.other_range, hit.other_incidence_cos));
      const Vector2d n = R_ref_world * hit.normal, arm = R_ref_world * (hit.point - T_world_scan.translation());
      const Eigen::Vector3d gradient(n.x(), n.y(), -n.x() * arm.y() + n.y() * arm.x());
      information += weight * gradient * gradient.transpose();
    }
  }
  const double turn_sigma = revolution_turn_sigma(lidar);
  return with_turned_scans(information, T_world_ref.inverse() * T_world_scan, turn_sigma * turn_sigma);
}

}  // namespace phasescan::sim
