#include "odometry/scan_to_scan.hpp"

#include <algorithm>
#include <utility>

#include "core/motion.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kLeastOverlap = 0.3;  // a match that explains less is no guess
constexpr double kCertain = 0.95;      // confidence
constexpr double kSlow = 0.9, kLeastCertainShare = 0.7;
constexpr std::size_t kMostLasers = 4;

}  // namespace

void ScanToScan::remember(RangeMeasurement measurement, const Pose2& T_odom_stamp, const Twist2& twist) {
  View view{std::move(measurement), T_odom_stamp, twist};
  const auto before = std::find_if(views_.begin(), views_.end(),
                                   [&](const View& v) { return v.measurement.laser == view.measurement.laser; });
  if (before != views_.end()) {
    view.certain_share = before->certain_share;
    views_.erase(before);
  } else if (views_.size() == kMostLasers) {
    views_.erase(views_.begin());
  }
  views_.push_back(std::move(view));
}

bool ScanToScan::knows(const LaserId& laser) const {
  return std::any_of(views_.begin(), views_.end(), [&](const View& v) { return v.measurement.laser == laser; });
}

ScanToScan::View* ScanToScan::view_of(const LaserId& laser) {
  for (View& view : views_) {
    if (view.measurement.laser == laser) return &view;
  }
  return views_.empty() ? nullptr : &views_.back();
}

std::optional<ScanToScan::Found> ScanToScan::find(const RangeMeasurement& measurement, const Twist2& twist) {
  View* last = view_of(measurement.laser);
  if (!last) return std::nullopt;
  const Pose2 &T_base_last = last->measurement.T_base_laser, &T_base_laser = measurement.T_base_laser;
  MatchHints hints;
  hints.reference_twist = twist_of_frame(T_base_last, last->twist);
  hints.scan_twist = twist_of_frame(T_base_laser, twist);
  const MatchResult match = matcher_.match(last->measurement.scan, measurement.scan, hints);
  const bool certain = match.usable && match.confidence.value_or(0.0) >= kCertain;
  last->certain_share = kSlow * last->certain_share + (1.0 - kSlow) * (certain ? 1.0 : 0.0);
  if (!match.usable && match.overlap <= kLeastOverlap) return std::nullopt;
  const Pose2 T_odom_ref = last->T_odom_stamp * T_base_last;
  return Found{T_odom_ref * match.T_ref_scan * T_base_laser.inverse(),
               rotate_information(match.covariance, T_odom_ref.theta), match.usable,
               certain && last->certain_share >= kLeastCertainShare};
}

}  // namespace phasescan
