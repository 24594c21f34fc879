/// What a run of days keeps of the way of long ago: the records of some scans, evenly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "phasescan/slam/result.hpp"
#include "slam/scan_ledger.hpp"

namespace phasescan {

struct OldScan {
  ScanId scan = 0;
  ScanRecord record;
};

/// Plain values.
class OldPath {
 public:
  /// Takes the records over that follow those which it has seen.
  void add(std::span<const ScanRecord> records);
  /// Leaves out every second scan, again and again, until at most `most` are kept beside the pinned ones.
  /// @param pinned  in order: scans that something else refers to
  void thin(std::size_t most, const std::vector<ScanId>& pinned);
  /// Scans from `first` on stand at a keyframe which was not known when they came.
  void stand_at(ScanId first, std::int32_t keyframe, const Pose2& T_keyframe_stamp);

  const std::vector<OldScan>& scans() const { return scans_; }
  /// The first scan that it has not seen.
  ScanId end() const { return end_; }

 private:
  std::vector<OldScan> scans_;  // those kept, in order
  ScanId end_ = 0;
  ScanId stride_ = 1;  // scans are kept whose numbers it divides
};

}  // namespace phasescan
