#include "io/ros_scan.hpp"

#include <algorithm>
#include <cmath>

#include "phasescan/core/pose2.hpp"

namespace phasescan::ros {
namespace {

constexpr double kSlack_rad = 0.01;
constexpr double kNarrowestFan_deg = 30.0;   ///< no scanner has a narrower one, read as degrees
constexpr double kLeastMillimetres = 100.0;  ///< no lidar of this project sees 100 m indoors in half of its beams
constexpr double kLeastMillimetreLimit = 1000.0;
constexpr std::size_t kEnoughReturns = 10;

double median_return(const std::vector<float>& ranges) {
  std::vector<float> returns;
  std::copy_if(ranges.begin(), ranges.end(), std::back_inserter(returns),
               [](float range) { return std::isfinite(range) && range > 0.0F; });
  if (returns.size() < kEnoughReturns) return 0.0;
  const auto middle = returns.begin() + static_cast<std::ptrdiff_t>(returns.size() / 2);
  std::nth_element(returns.begin(), middle, returns.end());
  return *middle;
}

}  // namespace

ScanUnits ScanReading::units_of(const LaserScan& message) {
  ScanUnits units;
  if (!range_unit_known_) {
    const double median = median_return(message.ranges);
    range_unit_known_ = median > 0.0;
    millimetres_ =
        median >= kLeastMillimetres && !(message.range_max > 0.0F && message.range_max < kLeastMillimetreLimit);
  }
  if (millimetres_) units.range = 1e-3;
  const auto n = static_cast<double>(message.ranges.size());
  const double step = std::abs(message.angle_increment), fan = step * (n - 1.0);
  const double span = double{message.angle_max} - double{message.angle_min};
  if (n < 2.0 || !(step > 0.0) || !std::isfinite(step)) return units;
  const bool ends_stated = std::isfinite(span) && span != 0.0;
  const bool ends_agree =
      ends_stated && std::abs(span - message.angle_increment * (n - 1.0)) <= 2.0 * step + kSlack_rad;
  if (fan <= kTwoPi + 2.0 * step + kSlack_rad) {
    contradicting_ends_ += ends_stated && !ends_agree;
    return units;
  }
  const bool fits_degrees = fan >= kNarrowestFan_deg && fan <= 360.0 + 2.0 * step;
  if (fits_degrees && ends_agree) {
    units.angle = kPi / 180.0;
  } else if (ends_stated && std::abs(span) <= kTwoPi + kSlack_rad) {
    units.increment_from_ends = true;
  } else if (fits_degrees) {
    units.angle = kPi / 180.0;
  }
  degrees_ += units.angle != 1.0;
  from_ends_ += units.increment_from_ends;
  beyond_turn_ += units.angle == 1.0 && !units.increment_from_ends;
  return units;
}

Scan ScanReading::read(const LaserScan& message) {
  ++scans_;
  Scan scan = to_scan(message, units_of(message));
  absurd_time_increments_ += message.time_increment != 0.0F && scan.time_increment == 0.0;
  return scan;
}

void ScanReading::add_remarks(const std::string& topic, std::vector<LogRemark>& out) const {
  const auto add = [&](std::size_t count, const char* kind, const char* what) {
    if (count == 0) return;
    out.push_back({kind, topic + ": " + std::to_string(count) + " of " + std::to_string(scans_) + " scans " + what});
  };
  add(degrees_, "angles in degrees", "state a fan of more than a turn in radians: their angles are read as degrees");
  add(from_ends_, "increment contradicts angle_max",
      "have an angle_increment that leads beyond a turn: it is taken from angle_min and angle_max");
  add(beyond_turn_, "fan beyond a turn", "state a fan of more than a turn: read as stated");
  add(contradicting_ends_, "increment contradicts angle_max",
      "do not end at their angle_max: angle_min and angle_increment are used");
  add(millimetres_ ? scans_ : 0, "ranges in millimetres", "have ranges of 100 and more: read as millimetres");
}

}  // namespace phasescan::ros
