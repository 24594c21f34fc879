#include "slam/input_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace phasescan {
namespace {

constexpr double kReorderedS = 1.0;  // [s] stamps that go back by less are loggers' disorder, by more a broken clock
constexpr double kGapS = 10.0;       // [s] without a scan
constexpr double kFewShare = 0.2;    // of the beams that have a range
// What a robot may do between two scans: way and turn at once, and its speed over a pause. Beyond it, odometry jumped.
constexpr double kMovedM = 0.02,
                 kMovedRad = 0.01;  // more than wheels creep at a stand; it changes the ranges of every sensor
constexpr double kLeapM = 2.0, kLeapRad = 2.0, kFastestMps = 3.0, kTurnPauseS = 1.0;

std::uint64_t fingerprint_of(const Scan& scan) {
  std::uint64_t h = 1469598103934665603ULL;  // FNV-1a
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

void check_stamps(const InputCheckState::Laser& last, const Scan& scan, bool repeated, std::vector<OddityNote>& notes) {
  const double step = stamp_to_seconds(scan.stamp - last.stamp);
  if (repeated) notes.push_back({"repeated scan", true, "the same scan as the one before; it counts once"});
  if (step < -kReorderedS) {
    notes.push_back({"time going backwards", true,
                     "time goes back by " + milliseconds(last.stamp, scan.stamp) + "; the order of the file is kept"});
  }
  if (step < 0.0 && step >= -kReorderedS) {
    notes.push_back(
        {"stamps out of order", false,
         "stamps out of order by " + milliseconds(last.stamp, scan.stamp) + "; the order of the file is kept"});
  }
  if (step == 0.0 && !repeated) {
    notes.push_back(
        {"same stamp", false, "another scan with the stamp of the one before; nothing is read from their times"});
  }
  if (step > kGapS) notes.push_back({"gap", false, "no scan for " + milliseconds(last.stamp, scan.stamp)});
  if (scan.size() != last.beams) {
    notes.push_back(
        {"beam count changes", false, std::to_string(scan.size()) + " beams after " + std::to_string(last.beams)});
  }
}

void check_returns(const Scan& scan, std::vector<OddityNote>& notes) {
  const std::size_t hits = scan.hit_count();
  if (hits == 0) {
    notes.push_back({"scan without a return", false, "not one beam has a range"});
  } else if (static_cast<double>(hits) < kFewShare * static_cast<double>(scan.size())) {
    notes.push_back({"few returns", false,
                     "only " + std::to_string(hits) + " of " + std::to_string(scan.size()) +
                         " beams have a range; what is made of such scans is less certain"});
  }
}

void check_odometry(const InputCheckState& state, const Pose2& odometry, Stamp stamp, std::vector<OddityNote>& notes) {
  if (!state.odometry) return;
  const Pose2 step = state.odometry->inverse() * odometry;
  const double pause_s = std::max(0.0, stamp_to_seconds(stamp - state.odometry_stamp));
  const double way = std::hypot(step.x, step.y), turn = std::abs(step.theta);
  if (way <= kLeapM + kFastestMps * pause_s && (turn <= kLeapRad || pause_s >= kTurnPauseS)) return;
  notes.push_back({"odometry jump", true,
                   "odometry jumps by " + std::to_string(std::llround(100.0 * way)) + " cm and " +
                       std::to_string(std::llround(rad_to_deg(turn))) + " deg; it is not followed"});
}

/// Whether the wheels say that the robot moved since the last measurement.
bool has_moved(const InputCheckState& state, const RangeMeasurement& measurement) {
  if (!state.odometry || !measurement.T_odom_base) return false;
  const Pose2 step = state.odometry->inverse() * *measurement.T_odom_base;
  const double way = std::hypot(step.x, step.y), turn = std::abs(step.theta);
  return (way > kMovedM || turn > kMovedRad) && way < kLeapM && turn < kLeapRad;
}

}  // namespace

void note_oddity(InputCheckState& state, const OddityNote& note, ScanId scan) {
  InputOddity& oddity = state.oddities[note.kind];
  if (oddity.count++ > 0) return;
  oddity.damage = note.damage;
  oddity.first = scan;
  oddity.what = note.what;
}

InputVerdict check_input(InputCheckState& state, const RangeMeasurement& measurement, ScanId id) {
  const Scan& scan = measurement.scan;
  InputVerdict verdict;
  const std::uint64_t fingerprint = fingerprint_of(scan);
  const auto known = state.lasers.find(measurement.laser);
  if (known != state.lasers.end()) {
    const InputCheckState::Laser& last = known->second;
    verdict.repeated = scan.stamp == last.stamp && scan.size() == last.beams && fingerprint == last.fingerprint &&
                       scan.hit_count() > 0;
    check_stamps(last, scan, verdict.repeated, verdict.notes);
    if (scan.stamp != last.stamp && fingerprint == last.fingerprint && scan.size() == last.beams &&
        has_moved(state, measurement)) {
      verdict.notes.push_back({"frozen scan", false,
                               "the ranges of the scan before under a new stamp, while the wheels moved: the driver "
                               "repeats itself"});
    }
  } else if (!state.lasers.empty()) {
    verdict.notes.push_back({"several lasers", false, "a second laser, " + measurement.laser + "; both are used"});
  }
  state.lasers[measurement.laser] = {scan.stamp, scan.size(), fingerprint};
  check_returns(scan, verdict.notes);
  if (measurement.T_odom_base) {
    check_odometry(state, *measurement.T_odom_base, scan.stamp, verdict.notes);
    state.odometry = measurement.T_odom_base;
    state.odometry_stamp = scan.stamp;
  }
  for (const OddityNote& note : verdict.notes) note_oddity(state, note, id);
  return verdict;
}

}  // namespace phasescan
