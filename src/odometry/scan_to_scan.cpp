#include "odometry/scan_to_scan.hpp"

#include <algorithm>
#include <utility>

#include "core/motion.hpp"
#include "odometry/information.hpp"

namespace phasescan {
namespace {

constexpr double kLeastOverlap = 0.3;  // a match that explains less is no guess
// A match is certain from this confidence on, if so many of those before were: a slow share with this memory.
constexpr double kCertain = 0.95, kLeastCertainShare = 0.7, kMemoryOfShare = 0.9;
constexpr std::size_t kMostLasers = 4;

}  // namespace

void LastScans::remember(RangeMeasurement measurement, const Pose2& T_odom_stamp, const Twist2& twist) {
  LastScan next{std::move(measurement), T_odom_stamp, twist};
  const auto before = std::find_if(scans.begin(), scans.end(),
                                   [&](const LastScan& s) { return s.measurement.laser == next.measurement.laser; });
  if (before != scans.end()) {
    next.certain_share = before->certain_share;
    scans.erase(before);
  } else if (scans.size() == kMostLasers) {
    scans.erase(scans.begin());
  }
  scans.push_back(std::move(next));
}

bool LastScans::knows(const LaserId& laser) const {
  return std::any_of(scans.begin(), scans.end(), [&](const LastScan& s) { return s.measurement.laser == laser; });
}

LastScan* LastScans::of(const LaserId& laser) {
  for (LastScan& scan : scans) {
    if (scan.measurement.laser == laser) return &scan;
  }
  return scans.empty() ? nullptr : &scans.back();
}

std::optional<ScanToScan::Found> ScanToScan::find(LastScans& last_scans, const RangeMeasurement& measurement,
                                                  const Twist2& twist) {
  LastScan* last = last_scans.of(measurement.laser);
  if (!last) return std::nullopt;
  const Pose2 &T_base_last = last->measurement.T_base_laser, &T_base_laser = measurement.T_base_laser;
  MatchHints hints;
  hints.reference_twist = twist_of_frame(T_base_last, last->twist);
  hints.scan_twist = twist_of_frame(T_base_laser, twist);
  const MatchResult match = matcher_.match(last->measurement.scan, measurement.scan, hints);
  const bool certain = match.usable && match.confidence.value_or(0.0) >= kCertain;
  last->certain_share = kMemoryOfShare * last->certain_share + (1.0 - kMemoryOfShare) * (certain ? 1.0 : 0.0);
  if (!match.usable && match.overlap <= kLeastOverlap) return std::nullopt;
  const Pose2 T_odom_ref = last->T_odom_stamp * T_base_last;
  return Found{T_odom_ref * match.T_ref_scan * T_base_laser.inverse(),
               rotate_information(match.diagnostics.noise_covariance, T_odom_ref.theta), match.usable,
               certain && last->certain_share >= kLeastCertainShare};
}

}  // namespace phasescan
