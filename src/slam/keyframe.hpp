/// A keyframe: a scan that the map is made of.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"
#include "slam/keyframe_points.hpp"
#include "slam/scan_store.hpp"

namespace phasescan {

struct Keyframe {
  std::shared_ptr<const KeyframePoints> points;  ///< in the frame of the base at mid-scan
  Pose2 T_odom_base;                             ///< as laser odometry found it
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Identity();           ///< of the step from the keyframe before, frame of the base
  bool new_segment = false;                  ///< nothing but a guess ties it to the keyframe before
  std::int64_t scan = 0;                     ///< index of its scan in the log
  std::shared_ptr<const StoredScan> stored;  ///< its scan, where all scans are kept
  std::shared_ptr<const Scan> own_scan;      ///< the scan itself in bounded-memory mode
  LaserId laser;
  Pose2 T_base_laser;                                ///< at its scan's stamp
  Twist2 twist;                                      ///< of the base during its turn
  Pose2 T_mid_stamp;                                 ///< the base at the scan's first beam, seen from mid-scan
  std::int32_t session = 0;                          ///< which drive: nothing but loops ties one to another
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mean of its points: what it looks at, frame of the base

  /// The scan; empty where none is kept.
  Scan scan_data() const { return own_scan ? *own_scan : stored ? stored->scan() : Scan{}; }

  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("points", self.points);
    v("T_odom_base", self.T_odom_base);
    v("information", self.information);
    v("new_segment", self.new_segment);
    v("scan", self.scan);
    v("stored", self.stored);
    v("own_scan", self.own_scan);
    v("laser", self.laser);
    v("T_base_laser", self.T_base_laser);
    v("twist", self.twist);
    v("T_mid_stamp", self.T_mid_stamp);
    v("session", self.session);
    v("centre", self.centre);
  }
};

}  // namespace phasescan
