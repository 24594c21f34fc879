/// A keyframe: a scan that the map is made of.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "phasescan/core/pose2.hpp"
#include "odometry/map_points.hpp"
#include "phasescan/scan/range_measurement.hpp"

namespace phasescan {

struct Keyframe {
  std::shared_ptr<const MapPoints> points;  ///< in the frame of the base at mid-scan
  Pose2 T_odom_base;                        ///< as laser odometry found it
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Identity();       ///< of the step from the keyframe before, frame of the base
  bool new_segment = false;              ///< nothing but a guess ties it to the keyframe before
  std::int64_t scan = 0;                 ///< index of its scan in the log
  std::size_t stored = 0;                ///< number of its scan in the store, where scans are kept there
  std::shared_ptr<const Scan> own_scan;  ///< the scan itself in bounded-memory mode
  LaserId laser;
  Pose2 T_base_laser;                                ///< at its scan's stamp
  Twist2 twist;                                      ///< of the base during its turn
  Pose2 T_mid_stamp;                                 ///< the base at the scan's first beam, seen from mid-scan
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mean of its points: what it looks at, frame of the base
};

}  // namespace phasescan
