#include "phasescan/odometry/safety_net.hpp"

#include "phasescan/odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kLeastOverlap = 0.3;  // a match that explains less is no guess

}  // namespace

void SafetyNet::remember(const Scan& scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist) {
  scan_ = scan;
  mount_ = mount;
  T_odom_stamp_ = T_odom_stamp;
  twist_ = twist;
}

std::optional<SafetyNet::Catch> SafetyNet::find(const Scan& scan, const LaserMount& mount, bool doubtful) {
  // Two lasers of which one is upside down see mirrored worlds.
  if (!scan_ || mount.flipped != mount_.flipped) return std::nullopt;
  MatchHints hints;
  hints.reference_twist = mount_.laser_twist(twist_);
  const MatchResult match = matcher_.match(*scan_, scan, hints);
  if (!match.usable && !(doubtful && match.overlap > kLeastOverlap)) return std::nullopt;
  Pose2 T_ref_scan = match.T_ref_scan;
  Eigen::Matrix3d covariance = match.covariance;
  if (mount.flipped) {
    T_ref_scan = {T_ref_scan.x, -T_ref_scan.y, -T_ref_scan.theta};
    const Eigen::Vector3d mirror(1.0, -1.0, -1.0);
    covariance = mirror.asDiagonal() * match.covariance * mirror.asDiagonal();
  }
  const Pose2 T_odom_ref = T_odom_stamp_ * mount_.T_base_laser;
  return Catch{T_odom_ref * T_ref_scan * mount.T_base_laser.inverse(), rotate_information(covariance, T_odom_ref.theta),
               match.usable};
}

}  // namespace phasescan
