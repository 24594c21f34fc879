#include "odometry/checked_tracker.hpp"

#include <algorithm>
#include <utility>

#include "core/motion.hpp"

namespace phasescan {
namespace {

// What is held against a scan: the share of the usual score that it lacks, and what its motion is off, by so much a
// metre and a radian: robots change their motion by less than 5 cm and 3 degrees from scan to scan.
constexpr double kPerM = 2.0, kPerRad = 2.0;
constexpr double kNotMatched = 1.0;  // the same of a scan that was not matched
// More than the first makes a scan suspect (99 of 100 sound scans have less). The next ones must lack so much less,
// together, where it is left out than where it counts.
constexpr double kSuspect = 0.2, kMargin = 0.3;
constexpr double kEachLeftOut = 0.05;  // what speaks against leaving out another scan
// Of the next scan without them: else it fits no better. Turns begin and end too, so much more is held against bad
// ones.
constexpr double kMostAfter = 0.5, kFarBetter = 1.0 / 3.0;
constexpr std::size_t kMostInARow = 3;  // scans that wait

double against(const TrackerStep& step) {
  if (!step.fit.judged) return 0.0;
  if (!step.tracked()) return kNotMatched;
  return std::max(0.0, 1.0 - step.fit.score_share) + kPerM * step.fit.off_m + kPerRad * step.fit.off_rad;
}

}  // namespace

CheckedStep CheckedTracker::add(const RangeMeasurement& measurement) {
  if (suspects_.before) return add_after_suspects(measurement);
  CheckedStep out;
  OdometryState before = tracker_.state();
  out.step = tracker_.add(measurement);
  if (against(out.step) <= kSuspect) return out;
  suspects_.before = std::move(before);
  suspect(measurement, out);
  return out;
}

void CheckedTracker::suspect(const RangeMeasurement& measurement, CheckedStep& out) {
  out.suspect = true;
  suspects_.scans.push_back({measurement, out.step});
  if (out.step.tracked()) out.step.status = TrackingStatus::kDegraded;
  out.step.keyframe = false;
  out.step.keyframes.clear();
}

CheckedStep CheckedTracker::add_after_suspects(const RangeMeasurement& measurement) {
  CheckedStep out;
  const OdometryState after = tracker_.state();
  const auto count = static_cast<double>(suspects_.scans.size());
  double with_them = 0.0;
  for (const SuspectScan& suspect : suspects_.scans) with_them += against(suspect.step);
  // From before them, as if they had never come: their numbers stay theirs.
  OdometryState before = *suspects_.before;
  before.scans = after.scans;
  tracker_.restore(std::move(before));
  TrackerStep without = tracker_.add(measurement);
  const double without_them = against(without) + kEachLeftOut * count;
  OdometryState after_without = tracker_.state();
  tracker_.restore(after);
  out.step = tracker_.add(measurement);
  const double last = against(out.step);
  with_them += last;
  const bool fits_before =
      without.fit.judged && without.tracked() && (without_them < kMostAfter || without_them < kFarBetter * with_them);
  if (fits_before && without_them + kMargin < with_them) {
    tracker_.restore(std::move(after_without));
    out.step = std::move(without);
    leave_out(out.step, out.settled);
  } else if (last <= kSuspect || suspects_.scans.size() >= kMostInARow) {
    accept(out.settled);
  } else {
    suspect(measurement, out);
  }
  return out;
}

std::vector<SettledScan> CheckedTracker::finish() {
  std::vector<SettledScan> settled;
  accept(settled);
  return settled;
}

void CheckedTracker::leave_out(const TrackerStep& next, std::vector<SettledScan>& settled) {
  const Pose2 T_odom_before = suspects_.before->T_odom_mid;
  const Pose2 way = T_odom_before.inverse() * next.T_odom_mid,
              T_mid_stamp = next.T_odom_mid.inverse() * next.T_odom_stamp;
  const double parts = static_cast<double>(suspects_.scans.size()) + 1.0;
  double part = 0.0;
  for (SuspectScan& suspect : suspects_.scans) {
    SettledScan scan{std::move(suspect.measurement), std::move(suspect.step), true};
    scan.step.status = TrackingStatus::kLost;
    scan.step.T_odom_mid = T_odom_before * scale_motion(way, ++part / parts);
    scan.step.T_odom_stamp = scan.step.T_odom_mid * T_mid_stamp;
    scan.step.keyframe = false;
    scan.step.keyframes.clear();
    settled.push_back(std::move(scan));
  }
  suspects_ = {};
}

void CheckedTracker::accept(std::vector<SettledScan>& settled) {
  for (SuspectScan& suspect : suspects_.scans)
    settled.push_back({std::move(suspect.measurement), std::move(suspect.step), false});
  suspects_ = {};
}

}  // namespace phasescan
