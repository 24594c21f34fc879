// How much of what a sensor sends is lost on the line, and what a pose is worth then.
#pragma once

#include "phasescan/live/live.hpp"

namespace phasescan::live {

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
