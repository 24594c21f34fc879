#include "phasescan/odometry/scan_to_scan.hpp"

#include "phasescan/odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kLeastOverlap = 0.3;  // a match that explains less is no guess
constexpr double kCertain = 0.99;      // confidence
constexpr double kSlow = 0.9, kLeastCertainShare = 0.7;

}  // namespace

void ScanToScan::remember(const Scan& scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist) {
  scan_ = scan;
  mount_ = mount;
  T_odom_stamp_ = T_odom_stamp;
  twist_ = twist;
}

std::optional<ScanToScan::Found> ScanToScan::find(const Scan& scan, const LaserMount& mount, const Twist2& twist) {
  // Two lasers of which one is upside down see mirrored worlds.
  if (!scan_ || mount.flipped != mount_.flipped) return std::nullopt;
  MatchHints hints;
  hints.reference_twist = mount_.laser_twist(twist_);
  hints.scan_twist = mount.laser_twist(twist);
  const MatchResult match = matcher_.match(*scan_, scan, hints);
  const bool certain = match.usable && match.confidence.value_or(0.0) >= kCertain;
  certain_share_ = kSlow * certain_share_ + (1.0 - kSlow) * (certain ? 1.0 : 0.0);
  if (!match.usable && match.overlap <= kLeastOverlap) return std::nullopt;
  Pose2 T_ref_scan = match.T_ref_scan;
  Eigen::Matrix3d covariance = match.covariance;
  if (mount.flipped) {
    T_ref_scan = {T_ref_scan.x, -T_ref_scan.y, -T_ref_scan.theta};
    const Eigen::Vector3d mirror(1.0, -1.0, -1.0);
    covariance = mirror.asDiagonal() * match.covariance * mirror.asDiagonal();
  }
  const Pose2 T_odom_ref = T_odom_stamp_ * mount_.T_base_laser;
  return Found{T_odom_ref * T_ref_scan * mount.T_base_laser.inverse(), rotate_information(covariance, T_odom_ref.theta),
               match.usable, certain && certain_share_ >= kLeastCertainShare};
}

}  // namespace phasescan
