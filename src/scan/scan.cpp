#include "phasescan/scan/scan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace phasescan {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr double kMostRange_m = 1e6;    // no sensor sees so far; squares and fourth powers of it fit a float
constexpr double kMostAngle_rad = 1e4;  // beyond it a float no longer tells one beam from the next

void check_angle(const char* name, double angle) {
  if (std::abs(angle) <= kMostAngle_rad) return;
  throw std::invalid_argument(std::string("scan.") + name + ": a beam at " + std::to_string(angle) +
                              " rad; expected at most 1e4");
}

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
    check_angle("angles", static_cast<double>(angle));
  }
  Scan scan;
  scan.geometry = geometry;
  if (angles.empty()) {
    if (!std::isfinite(geometry.angle_min)) throw std::invalid_argument("scan.angle_min: not finite");
    if (raw.size() > 1 && !(std::isfinite(geometry.angle_increment) && geometry.angle_increment != 0.0)) {
      throw std::invalid_argument("scan.angle_increment: must be finite and not 0");
    }
    check_angle("angle_min", geometry.angle_min);
    if (raw.size() > 1)
      check_angle("angle_increment",
                  geometry.angle_min + static_cast<double>(raw.size() - 1) * geometry.angle_increment);
  }
  // Drivers fill the limits with nonsense often enough (0, NaN, max below min): unknown then.
  double& low = scan.geometry.range_min;
  double& high = scan.geometry.range_max;
  if (!(low > 0.0 && low <= kMostRange_m)) low = 0.0;
  if (!(high > low && high <= kMostRange_m)) high = 0.0;

  const auto limit_low = static_cast<float>(low);
  const auto limit_high = static_cast<float>(high > 0.0 ? high : kMostRange_m);
  scan.ranges.resize(raw.size());
  scan.states.resize(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    scan.states[i] = classify(raw[i], limit_low, limit_high);
    // Without a stated limit nobody said that the sensor looked so far.
    if (high == 0.0 && scan.states[i] == BeamState::kOutOfRange && std::isfinite(raw[i]))
      scan.states[i] = BeamState::kInvalid;
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
