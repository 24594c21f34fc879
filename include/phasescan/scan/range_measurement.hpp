/// What a robot hands over per scan: the scan, which laser it is from, and where laser and wheels stood at its stamp.
#pragma once

#include <optional>
#include <string>

#include "phasescan/core/pose2.hpp"
#include "phasescan/scan/scan.hpp"

namespace phasescan {

/// Which laser: a topic, a CARMEN keyword, any name; one laser may go without.
using LaserId = std::string;

/// One scan of one laser. A laser mounted upside down is mirrored before (`mirrored_scan`): here all see the world the
/// same way up.
struct RangeMeasurement {
  Scan scan;
  LaserId laser = {};                     ///< scans of one name are scans of one laser, wherever it is mounted
  Pose2 T_base_laser = {};                ///< at the scan's stamp; may differ from scan to scan (a laser that pans)
  std::optional<Pose2> T_odom_base = {};  ///< of the wheels at the scan's stamp

  /// Names every value, for what is kept of a run.
  template <class Self, class Visitor>
  static void visit(Self& self, Visitor&& v) {
    v("stamp", self.scan.stamp);
    v("angle_min", self.scan.geometry.angle_min);
    v("angle_increment", self.scan.geometry.angle_increment);
    v("range_min", self.scan.geometry.range_min);
    v("range_max", self.scan.geometry.range_max);
    v("time_increment", self.scan.time_increment);
    v("ranges", self.scan.ranges);
    v("states", self.scan.states);
    v("angles", self.scan.angles);
    v("intensities", self.scan.intensities);
    v("laser", self.laser);
    v("T_base_laser", self.T_base_laser);
    v("T_odom_base", self.T_odom_base);
  }
};

}  // namespace phasescan
