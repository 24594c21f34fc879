/// All that a tracker knows, as plain values: a copy is a checkpoint.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "odometry/map_points.hpp"
#include "odometry/motion_model.hpp"
#include "odometry/scan_clock.hpp"
#include "odometry/scan_to_scan.hpp"
#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// A scan that became part of the local map; handed out once, final.
struct TrackedKeyframe {
  std::int64_t scan = 0;  ///< how many scans came before it
  Stamp stamp = 0;
  Pose2 T_odom_base;                        ///< at mid-scan
  Pose2 T_mid_stamp;                        ///< the base at the scan's first beam, seen from mid-scan
  std::shared_ptr<const MapPoints> points;  ///< in the frame of the base at mid-scan, static ones
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  ///< of the pose relative to the keyframe before, frame of base
  bool new_segment = false;     ///< nothing but a prediction ties it to the keyframe before
  LaserId laser;
  Pose2 T_base_laser;
  Twist2 twist;  ///< of the base during its turn

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scan", self.scan);
    v("stamp", self.stamp);
    v("T_odom_base", self.T_odom_base);
    v("T_mid_stamp", self.T_mid_stamp);
    v("points", self.points);
    v("information", self.information);
    v("new_segment", self.new_segment);
    v("laser", self.laser);
    v("T_base_laser", self.T_base_laser);
    v("twist", self.twist);
  }
};

/// A keyframe of the local map, with all its points.
struct WindowKeyframe {
  std::shared_ptr<const MapPoints> points;
  Pose2 T_odom_base;  ///< at mid-scan

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("points", self.points);
    v("T_odom_base", self.T_odom_base);
  }
};

/// The first keyframe waits for the second scan: the motion between them says how the first was distorted.
struct FirstKeyframe {
  TrackedKeyframe keyframe;
  std::optional<RangeMeasurement> distorted;  ///< its scan, where that lasted some time and is to be deskewed
  double duration_s = 0.0;                    ///< of its turn

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("keyframe", self.keyframe);
    v("distorted", self.distorted);
    v("duration_s", self.duration_s);
  }
};

/// Poses since the robot came to rest, for the zero-velocity update.
struct Standstill {
  Pose2 first;  ///< T_odom_mid
  Pose2 sum;    ///< of the poses relative to it
  int count = 0;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("first", self.first);
    v("sum", self.sum);
    v("count", self.count);
  }
};

/// Whether taking the motion out of scans brings them closer to the map, tested on turns: the time between beams that a
/// log states may be none.
struct DeskewTest {
  int turns = 0;   ///< tested
  int better = 0;  ///< of them with the motion taken out

  // Where the times are true nearly all turns say so, else little more than half: the map was made by the same rule.
  bool decided() const { return turns >= 100; }
  bool refuted() const { return decided() && better < 85; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("turns", self.turns);
    v("better", self.better);
  }
};

struct OdometryState {
  static constexpr int kVersion = 1;

  std::int64_t scans = 0;  ///< added so far
  ScanClock clock;
  MotionModel motion;
  LastScans last_scans;
  std::vector<WindowKeyframe> window;  ///< the local map is made of these, around the last one; empty before the first
  std::optional<FirstKeyframe> first;
  Pose2 T_odom_mid;  ///< of the last scan
  RelativeUncertainty since_keyframe;
  Eigen::Matrix3d keyframe_covariance =
      Eigen::Matrix3d::Zero();  ///< of the last keyframe's pose, along the axes of odom
  double usual_score = 0.5;     ///< slow mean of the score of finished matches
  int untracked = 0;            ///< scans in a row without a match
  Standstill standstill;
  DeskewTest deskew_test;

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("scans", self.scans);
    v("clock", self.clock);
    v("motion", self.motion);
    v("last_scans", self.last_scans.scans);
    v("window", self.window);
    v("first", self.first);
    v("T_odom_mid", self.T_odom_mid);
    v("since_keyframe", self.since_keyframe);
    v("keyframe_covariance", self.keyframe_covariance);
    v("usual_score", self.usual_score);
    v("untracked", self.untracked);
    v("standstill", self.standstill);
    v("deskew_test", self.deskew_test);
  }
};

}  // namespace phasescan
