// How much of what a sensor sends is lost on the line, and what a pose is worth then.
#pragma once

#include <optional>

#include "phasescan/live/live.hpp"

namespace phasescan::live {

/// The share of beams that were lost on the line with a scan: those that are invalid in it, and those of whole turns
/// that are missing since the scan before. One turn may be: some sensors send every other one.
/// @param before  stamp of the scan before
double lost_share(const Scan& scan, std::optional<Stamp> before);

/// Follows the share of beams that scans lack. A match of what is left may be of another place that looks alike from
/// there: where most is lost no pose is called ok, and it is said once.
class LineDamage {
 public:
  /// The next scan. @param lost  share of its beams
  void add(double lost);
  bool is_heavy() const { return heavy_; }
  /// Makes what is known of the pose no better than it can be; tells where heavy damage began or ended.
  void judge(LiveUpdate& update);

 private:
  double lost_ = 0.0;  // of the last scans
  bool heavy_ = false, told_ = false;
};

}  // namespace phasescan::live
