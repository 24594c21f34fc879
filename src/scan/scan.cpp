#include "phasescan/scan/scan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace phasescan {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

BeamState classify(float raw, float range_min, float range_max) {
  if (raw > 0.0F && raw >= range_min && raw <= range_max) return BeamState::kHit;  // most are: asked first
  if (std::isnan(raw)) return BeamState::kInvalid;
  if (raw == 0.0F) return BeamState::kNoReturn;
  if (std::isinf(raw)) return raw > 0.0F ? BeamState::kOutOfRange : BeamState::kTooNear;
  if (raw < 0.0F) return BeamState::kInvalid;
  return raw < range_min ? BeamState::kTooNear : BeamState::kOutOfRange;
}

}  // namespace

std::size_t Scan::hit_count() const {
  return static_cast<std::size_t>(std::count(states.begin(), states.end(), BeamState::kHit));
}

double Scan::effective_range_max() const {
  if (geometry.range_max > 0.0) return geometry.range_max;
  float longest = 0.0F;
  for (std::size_t i = 0; i < size(); ++i) {
    if (is_hit(i)) longest = std::max(longest, ranges[i]);
  }
  return static_cast<double>(longest);
}

Scan make_scan(std::span<const float> raw, const ScanGeometry& geometry, std::span<const float> angles) {
  if (!angles.empty() && angles.size() != raw.size()) {
    throw std::invalid_argument("scan.angles: " + std::to_string(angles.size()) + " angles for " +
                                std::to_string(raw.size()) + " ranges");
  }
  for (const float angle : angles) {
    if (!std::isfinite(angle)) throw std::invalid_argument("scan.angles: an angle is not finite");
  }
  Scan scan;
  scan.geometry = geometry;
  if (angles.empty()) {
    if (!std::isfinite(geometry.angle_min)) throw std::invalid_argument("scan.angle_min: not finite");
    if (raw.size() > 1 && !(std::isfinite(geometry.angle_increment) && geometry.angle_increment != 0.0)) {
      throw std::invalid_argument("scan.angle_increment: must be finite and not 0");
    }
  }
  // Drivers fill the limits with nonsense often enough (0, NaN, max below min): unknown then.
  double& low = scan.geometry.range_min;
  double& high = scan.geometry.range_max;
  if (!(low > 0.0) || !std::isfinite(low)) low = 0.0;
  if (!(high > low) || !std::isfinite(high)) high = 0.0;

  const auto limit_low = static_cast<float>(low);
  const float limit_high = high > 0.0 ? static_cast<float>(high) : std::numeric_limits<float>::max();
  scan.ranges.resize(raw.size());
  scan.states.resize(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    scan.states[i] = classify(raw[i], limit_low, limit_high);
    scan.ranges[i] = scan.states[i] == BeamState::kHit ? raw[i] : kMissing;
  }
  scan.angles.assign(angles.begin(), angles.end());
  return scan;
}

float raw_range(const Scan& scan, std::size_t i) {
  switch (scan.states[i]) {
    case BeamState::kHit:
      return scan.ranges[i];
    case BeamState::kNoReturn:
      return 0.0F;
    case BeamState::kOutOfRange:
      return std::numeric_limits<float>::infinity();
    case BeamState::kTooNear:
      return -std::numeric_limits<float>::infinity();
    case BeamState::kInvalid:
      break;
  }
  return kMissing;
}

Scan reduce_scan(const Scan& scan, double range_max, int beam_step) {
  if (beam_step < 1) throw std::invalid_argument("beam_step: must be 1 or more");
  const auto step = static_cast<std::size_t>(beam_step);
  Scan out;
  out.stamp = scan.stamp;
  out.geometry = scan.geometry;
  out.geometry.angle_increment *= beam_step;
  out.time_increment = scan.time_increment * beam_step;
  if (range_max > 0.0) {
    out.geometry.range_max = scan.geometry.range_max > 0.0 ? std::min(scan.geometry.range_max, range_max) : range_max;
  }
  for (std::size_t i = 0; i < scan.size(); i += step) {
    const bool cut = range_max > 0.0 && scan.is_hit(i) && static_cast<double>(scan.ranges[i]) > range_max;
    out.ranges.push_back(cut ? kMissing : scan.ranges[i]);
    out.states.push_back(cut ? BeamState::kOutOfRange : scan.states[i]);
    if (!scan.angles.empty()) out.angles.push_back(scan.angles[i]);
    if (!scan.intensities.empty()) out.intensities.push_back(scan.intensities[i]);
  }
  return out;
}

Scan mirrored_scan(const Scan& scan) {
  Scan out = scan;
  out.geometry.angle_min = -scan.geometry.angle_min;
  out.geometry.angle_increment = -scan.geometry.angle_increment;
  for (float& angle : out.angles) angle = -angle;
  return out;
}

}  // namespace phasescan
