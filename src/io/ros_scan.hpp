/// What a scan message means that contradicts itself: drivers state degrees for radians, millimetres for metres, and
/// ends that their own increment does not reach.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/ros_messages.hpp"
#include "phasescan/io/log.hpp"

namespace phasescan::ros {

/// Reads the messages of one topic.
///
///   fan by the increment beyond a turn   degrees, where the ends say the same fan and it fits into 360;
///                                        else the increment is taken from the ends, where these fit into a turn
///   ends against the increment           the increment counts, as in most tools
///   ranges of 100 and more               millimetres, where range_max is 1000 or more, or unknown; told by the first
///                                        scan with ten returns
///   intensities that are not finite      0, as in every format
class ScanReading {
 public:
  /// @throws DecodeError where the beams have no direction.
  Scan read(const LaserScan& message);

  /// Scans whose time_increment was absurd and read as unknown.
  std::size_t absurd_time_increments() const { return absurd_time_increments_; }
  /// One remark for each contradiction that was met. `topic` begins their texts.
  void add_remarks(const std::string& topic, std::vector<LogRemark>& out) const;

 private:
  ScanUnits units_of(const LaserScan& message);

  std::size_t scans_ = 0, degrees_ = 0, from_ends_ = 0, beyond_turn_ = 0, contradicting_ends_ = 0;
  std::size_t absurd_time_increments_ = 0;
  bool range_unit_known_ = false, millimetres_ = false;
};

}  // namespace phasescan::ros
