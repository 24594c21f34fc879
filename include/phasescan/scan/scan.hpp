/// One turn of a planar lidar: ranges, where each beam points, why a beam has no range; and what a robot hands over
/// with it: which laser it is from, and where laser and wheels stood at its stamp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "phasescan/core/pose2.hpp"
#include "phasescan/core/time.hpp"

namespace phasescan {

/// What a beam said. Everything but kHit is "missing" and has NaN as its range (REP 117 reasons where they are known).
enum class BeamState : std::uint8_t {
  kHit = 0,
  kNoReturn,    ///< 0 on input: the sensor gives no reason (out of range, absorbing, glass, ...)
  kOutOfRange,  ///< +inf, or a number above range_max
  kTooNear,     ///< -inf, or a positive number below range_min
  kInvalid,     ///< NaN, null or a negative number
};

/// How the beams lie. Any beam count; a negative increment is a clockwise sensor.
struct ScanGeometry {
  double angle_min = 0.0;  ///< direction of beam 0 [rad], counter-clockwise from x forward
  double angle_increment =
      0.0;                 ///< [rad] between beams, negative for clockwise; not 0 when there are two beams or more
  double range_min = 0.0;  ///< [m], 0 = unknown
  double range_max = 0.0;  ///< [m], 0 = unknown: taken from the data
};

/// A scan. Invariants (kept by `make_scan`): states.size() == ranges.size(); ranges[i] is finite, > 0 and inside the
/// limits exactly where states[i] == kHit and NaN elsewhere; `angles`, `intensities` are empty or of the same size.
struct Scan {
  Stamp stamp = 0;              ///< time of the first beam [ns]
  ScanGeometry geometry;        ///< as stated by the input
  double time_increment = 0.0;  ///< [s] between beams, 0 = unknown or all at once
  std::vector<float> ranges;    ///< [m]
  std::vector<BeamState> states;
  std::vector<float> angles;       ///< [rad] per beam, replaces geometry's angles when not empty
  std::vector<float> intensities;  ///< empty if the sensor gives none

  std::size_t size() const { return ranges.size(); }
  bool empty() const { return ranges.empty(); }
  bool is_hit(std::size_t i) const { return states[i] == BeamState::kHit; }

  /// Direction of beam i [rad], not wrapped.
  double angle(std::size_t i) const {
    return angles.empty() ? geometry.angle_min + static_cast<double>(i) * geometry.angle_increment
                          : static_cast<double>(angles[i]);
  }

  /// Beam i has no range from now on.
  void miss(std::size_t i, BeamState why) {
    ranges[i] = std::numeric_limits<float>::quiet_NaN();
    states[i] = why;
  }

  /// Number of beams with a range.
  std::size_t hit_count() const;

  /// The stated range_max, or the longest hit where none is stated, or 0 without a hit. [m]
  double effective_range_max() const;
};

/// Builds a scan from raw ranges as sensors and files give them, sorting out why beams are missing.
///
/// @param raw          ranges [m]: 0, NaN, +-inf, below range_min, above range_max are missing; above 1e6 too, which no
///                     sensor measures (kInvalid where no range_max is stated)
/// @param geometry     nonsense limits (range_max <= range_min, NaN, negative, above 1e6 m) are read as unknown
/// @param angles       empty, or one direction per beam [rad]
/// @throws std::invalid_argument "scan.angle_increment: ..." for an increment that is 0 or not finite with two or more
///         beams and no angles, an angle_min that is not finite, a beam beyond +-1e4 rad, or angles of another count.
/// @cost   O(n)
Scan make_scan(std::span<const float> raw, const ScanGeometry& geometry, std::span<const float> angles = {});

/// Raw range of a beam as a ROS LaserScan would say it (REP 117): the range, +inf out of range, -inf too near, NaN
/// invalid, 0 for a sensor's unexplained "no return". `make_scan` of these values gives the same scan again.
float raw_range(const Scan& scan, std::size_t i);

/// The same scan cut down to a cheaper sensor: hits beyond `range_max` become out of range and range_max becomes it (0
/// keeps it), and only every `beam_step`-th beam stays.
Scan reduce_scan(const Scan& scan, double range_max, int beam_step);

/// The same beams in the mirror: every direction changes its sign. What a laser mounted upside down sees, as an upright
/// one.
Scan mirrored_scan(const Scan& scan);

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
