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

/// Steps of either sign as numbers that are small where the step is.
std::uint32_t fold(std::int32_t step) {
  return step < 0 ? ~(static_cast<std::uint32_t>(step) << 1) : static_cast<std::uint32_t>(step) << 1;
}
std::int32_t unfold(std::uint32_t folded) {
  return static_cast<std::int32_t>(folded & 1U ? ~(folded >> 1) : folded >> 1);
}

}  // namespace

StoredScan::StoredScan(const Scan& scan, const Pose2& T_base_laser, std::shared_ptr<const ScanKind> kind)
    : stamp_(scan.stamp),
      T_base_laser_(T_base_laser),
      kind_(std::move(kind)),
      beams_(static_cast<std::uint32_t>(scan.size())) {
  codes_.reserve(2 * scan.size());
  std::int32_t before = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const std::int32_t code = encode(scan.ranges[i], scan.states[i]);
    // Seven bits a byte, the lowest first; the eighth says that another follows.
    std::uint32_t step = fold(code - before);
    for (; step > 0x7FU; step >>= 7) codes_.push_back(static_cast<std::uint8_t>(0x80U | (step & 0x7FU)));
    codes_.push_back(static_cast<std::uint8_t>(step));
    before = code;
  }
  codes_.shrink_to_fit();
}

Scan StoredScan::scan() const {
  Scan scan;
  scan.stamp = stamp_;
  scan.geometry = kind_->geometry;
  scan.time_increment = kind_->time_increment;
  scan.angles = kind_->angles;
  scan.ranges.resize(beams_);
  scan.states.resize(beams_);
  std::size_t at = 0;
  std::int32_t code = 0;
  for (std::size_t i = 0; i < beams_; ++i) {
    std::uint32_t step = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint32_t byte = codes_[at++];
      step |= (byte & 0x7FU) << shift;
      if (byte < 0x80U) break;
    }
    code += unfold(step);
    const bool hit = code <= kLargest;
    scan.states[i] = hit ? BeamState::kHit : static_cast<BeamState>(code - kLargest);
    scan.ranges[i] = hit ? kUnit * static_cast<float>(code) : std::numeric_limits<float>::quiet_NaN();
  }
  return scan;
}

bool StoredScan::is_sound() const {
  if (!kind_ || !T_base_laser_.is_finite() || (!kind_->angles.empty() && kind_->angles.size() != beams_)) return false;
  std::size_t at = 0;
  std::int64_t code = 0;
  for (std::uint32_t i = 0; i < beams_; ++i) {
    std::uint32_t step = 0;
    for (int shift = 0;; shift += 7) {
      if (at == codes_.size() || shift > 14) return false;
      const std::uint32_t byte = codes_[at++];
      step |= (byte & 0x7FU) << shift;
      if (byte < 0x80U) break;
    }
    code += unfold(step);
    if (code < 1 || code > kLargest + static_cast<int>(BeamState::kInvalid)) return false;
  }
  return at == codes_.size();
}

std::size_t ScanStore::add(const Scan& scan, const Pose2& T_base_laser) {
  // The newest kinds are looked at first; a log whose every scan has its own angles makes one kind per scan.
  std::shared_ptr<const ScanKind> kind;
  for (std::size_t k = kinds_.size(), looked = 0; k-- > 0 && looked < 4 && !kind; ++looked) {
    const ScanKind& known = *kinds_[k];
    if (same(known.geometry, scan.geometry) && known.time_increment == scan.time_increment &&
        known.angles == scan.angles)
      kind = kinds_[k];
  }
  if (!kind) {
    kind = std::make_shared<const ScanKind>(ScanKind{scan.geometry, scan.time_increment, scan.angles});
    kinds_.push_back(kind);
  }
  entries_.push_back(std::make_shared<const StoredScan>(scan, T_base_laser, std::move(kind)));
  return entries_.size() - 1;
}

void ScanStore::append(const ScanStore& other) {
  kinds_.insert(kinds_.end(), other.kinds_.begin(), other.kinds_.end());
  entries_.insert(entries_.end(), other.entries_.begin(), other.entries_.end());
}

}  // namespace phasescan
