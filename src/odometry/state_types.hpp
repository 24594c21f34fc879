/// What readers of saved states have to know of the types of scans and tracking.
#pragma once

#include <algorithm>
#include <cmath>

#include "odometry/checked_tracker.hpp"
#include "odometry/own_body.hpp"
#include "odometry/state.hpp"
#include "state/fields.hpp"

namespace phasescan {

template <>
inline constexpr int kStateEnumCount<BeamState> = 5;
template <>
inline constexpr int kStateEnumCount<TrackingStatus> = 5;
template <>
inline constexpr int kStateEnumCount<WheelConsistency> = 4;
template <>
inline constexpr int kStateEnumCount<MotionState> = 3;

template <>
struct StateFields<Scan> {
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.stamp);
    v("angle_min", self.geometry.angle_min);
    v("angle_increment", self.geometry.angle_increment);
    v("range_min", self.geometry.range_min);
    v("range_max", self.geometry.range_max);
    v("time_increment", self.time_increment);
    v("ranges", self.ranges);
    v("states", self.states);
    v("angles", self.angles);
    v("intensities", self.intensities);
  }
};

/// Farther from each other no two poses of one run are [m]: beyond it cells of a map have no number.
inline constexpr double kMostStateM = 1e7;
inline bool is_near(const Pose2& pose) {
  return std::abs(pose.x) < kMostStateM && std::abs(pose.y) < kMostStateM;
}

inline const char* state_problem(const Scan& scan) {
  const std::size_t n = scan.ranges.size();
  if (scan.states.size() != n || (!scan.angles.empty() && scan.angles.size() != n) ||
      (!scan.intensities.empty() && scan.intensities.size() != n))
    return "a scan whose beams are not of one number";
  const ScanGeometry& g = scan.geometry;
  if (!(std::abs(g.angle_min) < 1e5) || !(std::abs(g.angle_increment) < 1e5) || !(std::abs(g.range_min) < 1e7) ||
      !(std::abs(g.range_max) < 1e7) || !std::isfinite(scan.time_increment))
    return "a scan whose beams lie nowhere";
  for (const float a : scan.angles) {
    if (!(std::abs(a) < 1e5F)) return "a scan whose beams lie nowhere";
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (scan.is_hit(i) ? !(scan.ranges[i] > 0.0F && scan.ranges[i] < 1e7F) : !std::isnan(scan.ranges[i]))
      return "a scan whose ranges are none";
  }
  return nullptr;
}
inline const char* state_problem(const RangeMeasurement& m) {
  return is_near(m.T_base_laser) ? state_problem(m.scan) : "a laser that is mounted nowhere";
}
inline const char* state_problem(const MapPoints& points) {
  const std::size_t n = points.size();
  for (const auto* v : {&points.y, &points.nx, &points.ny, &points.variance, &points.normal_variance}) {
    if (v->size() != n) return "points whose numbers are not as many";
  }
  if (points.free_standing.size() != n || points.with_normal > n) return "points whose numbers are not as many";
  for (const auto* v : {&points.x, &points.y, &points.nx, &points.ny}) {
    for (const float value : *v) {
      if (!(std::abs(value) < 1e6F)) return "a point that is nowhere";
    }
  }
  return nullptr;
}
inline const char* state_problem(const ScanClock& clock) {
  const auto bad = [](double s) { return !std::isfinite(s); };
  const bool finite = std::none_of(clock.steps_s.begin(), clock.steps_s.end(), bad) && !bad(clock.period_s);
  return finite && clock.steps_s.size() <= 31 && clock.next <= std::min<std::size_t>(30, clock.steps_s.size())
             ? nullptr
             : "times between scans that cannot be";
}
inline const char* state_problem(const TrackedKeyframe& keyframe) {
  return keyframe.points != nullptr && is_near(keyframe.T_odom_base) ? nullptr : "a keyframe without points or place";
}
inline const char* state_problem(const WindowKeyframe& keyframe) {
  return keyframe.points != nullptr && is_near(keyframe.T_odom_base) ? nullptr : "a keyframe without points or place";
}
inline const char* state_problem(const LastScan& last) {
  return is_near(last.T_odom_stamp) ? nullptr : "a scan that is nowhere";
}
inline const char* state_problem(const OdometryState& state) {
  if (!is_near(state.T_odom_mid) || state.scans < 0) return "a robot that is nowhere";
  return state.last_scans.scans.size() <= 4 ? nullptr : "more last scans than there are lasers";
}
inline const char* state_problem(const SuspectState& state) {
  return state.scans.size() <= 3 && state.scans.empty() != state.before.has_value() ? nullptr
                                                                                    : "scans that wait for nothing";
}

}  // namespace phasescan
