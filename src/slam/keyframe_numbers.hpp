/// Numbers of keyframes where some of long ago were forgotten.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace phasescan {

/// All from `first` on are kept, and of those before it the ones in `old`.
class KeyframeNumbers {
 public:
  /// @param old  in order, below `first`
  KeyframeNumbers(std::vector<std::int32_t> old, std::int32_t first) : old_(std::move(old)), first_(first) {}

  /// How many are kept before a keyframe: its number, once those that are kept are counted.
  std::int32_t before(std::int32_t keyframe) const {
    const auto old = static_cast<std::int32_t>(std::lower_bound(old_.begin(), old_.end(), keyframe) - old_.begin());
    return keyframe < first_ ? old : old + keyframe - first_;
  }
  /// The keyframe, or where it was forgotten the next one that is kept.
  std::int32_t next(std::int32_t keyframe) const {
    if (keyframe >= first_) return keyframe;
    const auto at = std::lower_bound(old_.begin(), old_.end(), keyframe);
    return at == old_.end() ? first_ : *at;
  }

 private:
  std::vector<std::int32_t> old_;
  std::int32_t first_ = 0;
};

}  // namespace phasescan
