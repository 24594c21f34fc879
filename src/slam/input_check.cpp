#include "slam/input_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace phasescan {
namespace {

constexpr double kReorderedS = 1.0;  // stamps that go back by less are loggers' disorder, by more a broken clock
constexpr double kGapS = 10.0;
constexpr double kFewShare = 0.2;  // of the beams that have a range
constexpr double kLeapM = 2.0, kLeapRad = 2.0, kFastestMps = 3.0,
                 kTurnPauseS = 1.0;  // what a robot may do between two scans

std::size_t fingerprint_of(const Scan& scan) {
  std::size_t h = 1469598103934665603ULL;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint32_t bits = 0;
    if (scan.is_hit(i)) std::memcpy(&bits, &scan.ranges[i], sizeof bits);
    h = (h ^ bits) * 1099511628211ULL;
  }
  return h;
}

std::string milliseconds(Stamp from, Stamp to) {
  const double s = std::abs(stamp_to_seconds(to - from));
  return std::to_string(std::llround(s * 1000.0)) + " ms";
}

}  // namespace

void InputCheck::note(const std::string& kind, bool damage, const std::string& text) {
  InputOddity& o = oddities_[kind];
  if (o.count++ == 0) {
    o.damage = damage;
    o.first = text;
  }
}

bool InputCheck::add(const Scan& scan, const std::string& laser, const std::optional<Pose2>& odometry,
                     const std::string& where) {
  const auto known = lasers_.find(laser);
  const std::size_t fingerprint = fingerprint_of(scan);
  bool repeated = false;
  if (known == lasers_.end()) {
    if (!lasers_.empty()) note("several lasers", false, where + ": a second laser, " + laser + "; both are used");
    lasers_[laser] = {scan.stamp, scan.size(), fingerprint};
  } else {
    Laser& last = known->second;
    repeated = scan.stamp == last.stamp && scan.size() == last.beams && fingerprint == last.fingerprint &&
               scan.hit_count() > 0;
    const double step = stamp_to_seconds(scan.stamp - last.stamp);
    if (repeated) note("repeated scan", true, where + ": the same scan as the one before; it counts once");
    if (step < -kReorderedS)
      note("time going backwards", true,
           where + ": time goes back by " + milliseconds(last.stamp, scan.stamp) + "; the order of the file is kept");
    if (step < 0.0 && step >= -kReorderedS)
      note("stamps out of order", false,
           where + ": stamps out of order by " + milliseconds(last.stamp, scan.stamp) +
               "; the order of the file is kept");
    if (step == 0.0 && !repeated)
      note("same stamp", false,
           where + ": another scan with the stamp of the one before; nothing is read from their times");
    if (step > kGapS) note("gap", false, where + ": no scan for " + milliseconds(last.stamp, scan.stamp));
    if (scan.size() != last.beams)
      note("beam count changes", false,
           where + ": " + std::to_string(scan.size()) + " beams after " + std::to_string(last.beams));
    last = {scan.stamp, scan.size(), fingerprint};
  }
  const std::size_t hits = scan.hit_count();
  if (hits == 0) {
    note("scan without a return", false, where + ": not one beam has a range");
  } else if (static_cast<double>(hits) < kFewShare * static_cast<double>(scan.size())) {
    note("few returns", false,
         where + ": only " + std::to_string(hits) + " of " + std::to_string(scan.size()) +
             " beams have a range; what is made of such scans is less certain");
  }
  if (odometry && odometry_) {
    const Pose2 step = odometry_->inverse() * *odometry;
    const double pause_s = std::max(0.0, stamp_to_seconds(scan.stamp - odometry_stamp_));
    if (std::hypot(step.x, step.y) > kLeapM + kFastestMps * pause_s ||
        (std::abs(step.theta) > kLeapRad && pause_s < kTurnPauseS)) {
      note("odometry jump", true,
           where + ": odometry jumps by " + std::to_string(std::llround(100.0 * std::hypot(step.x, step.y))) +
               " cm and " + std::to_string(std::llround(rad_to_deg(std::abs(step.theta)))) +
               " deg; it is not followed");
    }
  }
  if (odometry) {
    odometry_ = odometry;
    odometry_stamp_ = scan.stamp;
  }
  return !repeated;
}

bool InputCheck::damaged() const {
  for (const auto& [kind, oddity] : oddities_) {
    if (oddity.damage) return true;
  }
  return false;
}

}  // namespace phasescan
