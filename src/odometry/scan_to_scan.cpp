#include "odometry/scan_to_scan.hpp"

#include <algorithm>
#include <utility>

#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kLeastOverlap = 0.3;  // a match that explains less is no guess
constexpr double kCertain = 0.95;      // confidence
constexpr double kSlow = 0.9, kLeastCertainShare = 0.7;
constexpr std::size_t kMostLasers = 4;

}  // namespace

void ScanToScan::remember(Scan scan, const LaserMount& mount, const Pose2& T_odom_stamp, const Twist2& twist) {
  View view{std::move(scan), mount, T_odom_stamp, twist};
  const auto before = std::find_if(views_.begin(), views_.end(), [&](const View& v) { return v.mount == mount; });
  if (before != views_.end()) {
    view.certain_share = before->certain_share;
    views_.erase(before);
  } else if (views_.size() == kMostLasers) {
    views_.erase(views_.begin());
  }
  views_.push_back(std::move(view));
}

bool ScanToScan::knows(const LaserMount& mount) const {
  return std::any_of(views_.begin(), views_.end(), [&](const View& v) { return v.mount == mount; });
}

ScanToScan::View* ScanToScan::view_of(const LaserMount& mount) {
  View* latest = nullptr;
  for (View& view : views_) {
    if (view.mount == mount) return &view;
    // Two lasers of which one is upside down see mirrored worlds.
    if (view.mount.flipped == mount.flipped) latest = &view;
  }
  return latest;
}

std::optional<ScanToScan::Found> ScanToScan::find(const Scan& scan, const LaserMount& mount, const Twist2& twist) {
  View* last = view_of(mount);
  if (!last) return std::nullopt;
  MatchHints hints;
  hints.reference_twist = last->mount.laser_twist(last->twist);
  hints.scan_twist = mount.laser_twist(twist);
  const MatchResult match = matcher_.match(last->scan, scan, hints);
  const bool certain = match.usable && match.confidence.value_or(0.0) >= kCertain;
  last->certain_share = kSlow * last->certain_share + (1.0 - kSlow) * (certain ? 1.0 : 0.0);
  if (!match.usable && match.overlap <= kLeastOverlap) return std::nullopt;
  Pose2 T_ref_scan = match.T_ref_scan;
  Eigen::Matrix3d covariance = match.covariance;
  if (mount.flipped) {
    T_ref_scan = {T_ref_scan.x, -T_ref_scan.y, -T_ref_scan.theta};
    const Eigen::Vector3d mirror(1.0, -1.0, -1.0);
    covariance = mirror.asDiagonal() * match.covariance * mirror.asDiagonal();
  }
  const Pose2 T_odom_ref = last->T_odom_stamp * last->mount.T_base_laser;
  return Found{T_odom_ref * T_ref_scan * mount.T_base_laser.inverse(), rotate_information(covariance, T_odom_ref.theta),
               match.usable, certain && last->certain_share >= kLeastCertainShare};
}

}  // namespace phasescan
