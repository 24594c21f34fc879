/// What is kept of every scan: where it stands relative to a keyframe, and how it was tracked. Small, since there may
/// be many.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"
#include "phasescan/odometry/odometry.hpp"
#include "state/fields.hpp"

namespace phasescan {

struct ScanRecord {
  Stamp stamp = 0;
  std::int32_t keyframe = -1;     ///< the one before it, -1: before the first
  float x = 0, y = 0, theta = 0;  ///< T_keyframe_stamp: the base at the scan's first beam
  TrackingStatus status = TrackingStatus::kInitialising;
  bool repeated = false;
  bool left_out = false;  ///< it fits neither neighbour

  Pose2 T_keyframe_stamp() const {
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(theta)};
  }
  void set(const Pose2& T_keyframe_stamp);

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.stamp);
    v("keyframe", self.keyframe);
    v("x", self.x);
    v("y", self.y);
    v("theta", self.theta);
    v("status", self.status);
    v("repeated", self.repeated);
    v("left_out", self.left_out);
  }
};

/// A symmetric 3 x 3 matrix in the six numbers xx xy xt yy yt tt, single precision.
struct PackedCovariance {
  std::array<float, 6> value{};

  static PackedCovariance of(const Eigen::Matrix3d& m);
  Eigen::Matrix3d matrix() const;
};

/// Plain values.
struct ScanLedger {
  static constexpr int kVersion = 1;
  std::vector<ScanRecord> records;
  std::vector<PackedCovariance>
      covariances;                     ///< of each scan's pose as it was known then; empty in bounded-memory mode
  std::vector<std::int32_t> breaks;    ///< keyframes at which a new local map was begun
  std::int32_t keyframes = 0;          ///< so far
  std::vector<std::int64_t> sessions;  ///< the first scan of each session but the first
  std::int64_t wheels_off = -1;        ///< the first scan at which wheels said something else than it, -1: none

  /// The drive that a scan is of, from 0.
  std::size_t session_of(std::size_t scan) const {
    return static_cast<std::size_t>(
        std::upper_bound(sessions.begin(), sessions.end(), static_cast<std::int64_t>(scan)) - sessions.begin());
  }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("records", self.records);
    v("covariances", self.covariances);
    v("breaks", self.breaks);
    v("keyframes", self.keyframes);
    v("sessions", self.sessions);
    visit_since(v, 3, "wheels_off", self.wheels_off);
  }
};

/// One pose per record, from those of its keyframe and the next: what the map corrected between two keyframes is spread
/// over the scans between them, but for breaks of tracking.
/// @param keyframes  T_map_base of each keyframe known so far; scans of later ones keep their pose in the odometry
/// frame
/// @param odometry   T_odom_base of the same keyframes
/// @cost O(records)
std::vector<Pose2> poses_of_scans(const ScanLedger& ledger, std::span<const Pose2> keyframes,
                                  std::span<const Pose2> odometry);

}  // namespace phasescan
