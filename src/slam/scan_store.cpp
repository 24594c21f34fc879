#include "slam/scan_store.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

constexpr float kUnit = 0.002F;            // [m]
constexpr std::uint16_t kLargest = 65000;  // codes above it are reasons

std::uint16_t encode(float range, BeamState state) {
  if (state == BeamState::kHit && range > kUnit * static_cast<float>(kLargest)) state = BeamState::kOutOfRange;
  if (state != BeamState::kHit) return static_cast<std::uint16_t>(kLargest + static_cast<int>(state));
  return static_cast<std::uint16_t>(std::clamp(std::round(range / kUnit), 1.0F, static_cast<float>(kLargest)));
}

bool same(const ScanGeometry& a, const ScanGeometry& b) {
  return a.angle_min == b.angle_min && a.angle_increment == b.angle_increment && a.range_min == b.range_min &&
         a.range_max == b.range_max;
}

}  // namespace

std::size_t ScanStore::add(const Scan& scan, const Pose2& T_base_laser) {
  Entry entry;
  entry.stamp = scan.stamp;
  entry.T_base_laser = T_base_laser;
  entry.ranges.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) entry.ranges[i] = encode(scan.ranges[i], scan.states[i]);
  // The newest kinds are looked at first; a log whose every scan has its own angles makes one kind per scan.
  std::size_t kind = kinds_.size();
  for (std::size_t k = kinds_.size(), looked = 0; k-- > 0 && looked < 4; ++looked) {
    const Kind& known = kinds_[k];
    if (same(known.geometry, scan.geometry) && known.time_increment == scan.time_increment &&
        known.angles == scan.angles) {
      kind = k;
      break;
    }
  }
  if (kind == kinds_.size()) kinds_.push_back({scan.geometry, scan.time_increment, scan.angles});
  entry.kind = static_cast<std::uint32_t>(kind);
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

Scan ScanStore::scan(std::size_t index) const {
  const Entry& entry = entries_.at(index);
  const Kind& kind = kinds_[entry.kind];
  Scan scan;
  scan.stamp = entry.stamp;
  scan.geometry = kind.geometry;
  scan.time_increment = kind.time_increment;
  scan.angles = kind.angles;
  scan.ranges.resize(entry.ranges.size());
  scan.states.resize(entry.ranges.size());
  for (std::size_t i = 0; i < entry.ranges.size(); ++i) {
    const std::uint16_t code = entry.ranges[i];
    const bool hit = code <= kLargest;
    scan.states[i] = hit ? BeamState::kHit : static_cast<BeamState>(code - kLargest);
    scan.ranges[i] = hit ? kUnit * static_cast<float>(code) : std::numeric_limits<float>::quiet_NaN();
  }
  return scan;
}

}  // namespace phasescan
