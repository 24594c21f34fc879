#include "slam/old_path.hpp"

#include <algorithm>

namespace phasescan {

void OldPath::add(std::span<const ScanRecord> records) {
  for (const ScanRecord& record : records) scans_.push_back({end_++, record});
}

void OldPath::thin(std::size_t most, const std::vector<ScanId>& pinned) {
  const auto is_pinned = [&pinned](const OldScan& old) {
    return std::binary_search(pinned.begin(), pinned.end(), old.scan);
  };
  for (;;) {
    std::erase_if(scans_, [&](const OldScan& old) { return old.scan % stride_ != 0 && !is_pinned(old); });
    const auto held = static_cast<std::size_t>(std::count_if(scans_.begin(), scans_.end(), is_pinned));
    if (scans_.size() <= most + held) return;
    stride_ *= 2;
  }
}

void OldPath::stand_at(ScanId first, std::int32_t keyframe, const Pose2& T_keyframe_stamp) {
  for (OldScan& old : scans_) {
    if (old.scan < first) continue;
    old.record.keyframe = keyframe;
    old.record.set(T_keyframe_stamp);
  }
}

}  // namespace phasescan
