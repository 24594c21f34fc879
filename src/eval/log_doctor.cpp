#include "eval/log_doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "eval/log_stamps.hpp"
#include "eval/motion_check.hpp"

namespace phasescan {
namespace {

/// What is counted of one laser.
struct Laser {
  std::size_t scans = 0, beams = 0, missing = 0, empty = 0;
  std::size_t fewest_beams = 0, most_beams = 0, beams_changed = 0, last_beams = 0;
  std::size_t doubled = 0;
  std::size_t without_range_max = 0;
  double longest_turn_seconds = 0.0;  ///< beams * time_increment
  std::uint64_t last_content = 0;
  std::vector<std::uint32_t> hits;  ///< by beam, while the count of beams stays
  StampStatistics stamps;
  MotionCheck motion;
};

/// FNV-1a over the bits of the ranges: equal scans have equal numbers.
std::uint64_t content_of(const Scan& scan) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint32_t bits = static_cast<std::uint32_t>(scan.states[i]);
    if (scan.is_hit(i)) std::memcpy(&bits, &scan.ranges[i], sizeof bits);
    hash = (hash ^ bits) * 1099511628211ULL;
  }
  return hash;
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

/// The longest run of beams that never hit anything, as a share of all.
std::size_t longest_blind_run(const std::vector<std::uint32_t>& hits) {
  std::size_t run = 0, longest = 0;
  for (const std::uint32_t count : hits) {
    run = count == 0 ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

void count_scan(Laser& laser, const Scan& scan) {
  const std::size_t n = scan.size();
  const std::size_t hits = scan.hit_count();
  ++laser.scans;
  laser.beams += n;
  laser.missing += n - hits;
  laser.empty += hits == 0 ? 1 : 0;
  laser.fewest_beams = laser.scans == 1 ? n : std::min(laser.fewest_beams, n);
  laser.most_beams = std::max(laser.most_beams, n);
  if (laser.scans > 1 && n != laser.last_beams) ++laser.beams_changed;
  if (laser.hits.size() == n || laser.scans == 1) {
    laser.hits.resize(n);
    for (std::size_t i = 0; i < n; ++i) laser.hits[i] += scan.is_hit(i) ? 1U : 0U;
  }
  laser.last_beams = n;
  const std::uint64_t content = content_of(scan);
  if (laser.scans > 1 && hits > 0 && content == laser.last_content) ++laser.doubled;
  laser.last_content = content;
  if (scan.geometry.range_max == 0.0) ++laser.without_range_max;
  laser.longest_turn_seconds = std::max(laser.longest_turn_seconds, scan.time_increment * static_cast<double>(n));
}

void find_in_scans(const Laser& laser, std::vector<Finding>& out) {
  if (laser.beams_changed > 0) {
    out.push_back({"beams vary",
                   fmt::format("{} to {} beams a scan, changing {} times", laser.fewest_beams, laser.most_beams,
                               laser.beams_changed),
                   "the driver sends what arrived in a turn; many mapping tools refuse such scans, phasescan does not",
                   "nothing for phasescan; for others resample in the driver (angle compensation, fixed count)"});
  }
  if (laser.without_range_max == laser.scans) {
    out.push_back({"range_max unknown", "no scan states a range_max above 0",
                   "a beam without a return cannot be told from one that saw nothing up to its limit",
                   "set range_max in the driver; until then the longest range of a scan stands for it"});
  }
  if (percent(laser.missing, laser.beams) > 50.0) {
    out.push_back({"beams missing",
                   fmt::format("{:.0f} % of all beams have no return", percent(laser.missing, laser.beams)),
                   "open space, glass or black surfaces beyond what the sensor can see; matches rest on few points",
                   "check range_min and range_max and the sensor's window; drive closer to walls"});
  }
  if (laser.empty > 0) {
    out.push_back({"empty scans", fmt::format("{} of {} scans have not one return", laser.empty, laser.scans),
                   "the driver sent a turn before data came, or lost sync",
                   "nothing for phasescan: they are passed over; look at the cable if there are many"});
  }
  const std::size_t blind = longest_blind_run(laser.hits);
  if (laser.scans >= 20 && laser.beams_changed == 0 && 10 * blind > laser.hits.size()) {
    out.push_back({"blind sector",
                   fmt::format("{} neighbouring beams of {} never had a return", blind, laser.hits.size()),
                   "the robot's own body, a mast or a mask of the driver hides part of the view",
                   "normal for a laser behind a body; else move the sensor"});
  }
  if (laser.doubled > 0) {
    out.push_back({"scans doubled", fmt::format("{} scans are the same as the one before", laser.doubled),
                   "a recorder or bridge sent a message twice; counted as standing still they falsify the odometry",
                   "record one topic once; check for two publishers"});
  }
}

void find_in_stamps(const Laser& laser, std::vector<Finding>& out) {
  const StampStatistics& stamps = laser.stamps;
  const double median = stamps.median_seconds();
  if (stamps.backwards() > 0) {
    out.push_back(
        {"stamps backwards",
         fmt::format("{} of {} scans are stamped before their predecessor", stamps.backwards(), stamps.count()),
         "speeds come out negative and odometry is looked up at the wrong time",
         "stamp scans where they are measured; check for a clock that was set while recording"});
  }
  if (stamps.repeated() > 0) {
    out.push_back({"stamps repeated", fmt::format("{} scans have the stamp of their predecessor", stamps.repeated()),
                   "no speed can be told between them", "use a clock with a finer step, or the driver's own time"});
  }
  if (median <= 0.0) return;
  const std::size_t bursts = stamps.shorter_than(0.2 * median);
  if (percent(bursts, stamps.count()) > 1.0) {
    out.push_back({"stamps in bursts",
                   fmt::format("{} scans follow within a fifth of the usual {:.3f} s", bursts, median),
                   "scans were stamped when they were received, in heaps, not when they were measured",
                   "stamp in the driver; a slow USB or network link delays messages"});
  }
  const std::size_t gaps = stamps.longer_than(std::max(3.0 * median, median + 0.2));
  if (gaps > 0) {
    out.push_back({"gaps", fmt::format("{} pauses of more than three times the usual {:.3f} s", gaps, median),
                   "the robot moved unseen; the next match has farther to search",
                   "look for lost messages: a full disk, a busy processor, a weak link"});
  }
  if (laser.longest_turn_seconds > 1.5 * median) {
    out.push_back({"time_increment absurd",
                   fmt::format("beams take {:.3f} s by time_increment, scans come every {:.3f} s",
                               laser.longest_turn_seconds, median),
                   "taking motion out of a scan would bend it",
                   "set time_increment to the scan time over the number of beams, or to 0"});
  }
}

void find_in_motion(const MotionCounts& motion, std::vector<Finding>& out) {
  if (motion.turns_opposite >= 5 && motion.turns_opposite > 4 * motion.turns_same) {
    out.push_back({"mirrored sensor",
                   fmt::format("in {} of {} turns the scans turn opposite to the odometry", motion.turns_opposite,
                               motion.turns_opposite + motion.turns_same),
                   "the laser is upside down or its angles run clockwise without saying so: the map comes out mirrored",
                   "publish the mounting with roll = pi in /tf_static, or set the driver's `inverted` flag"});
  }
  if (motion.moves_backwards >= 5 && motion.moves_backwards > 4 * motion.moves_same) {
    out.push_back({"mounted backwards",
                   fmt::format("in {} of {} straight runs the scans move opposite to the odometry",
                               motion.moves_backwards, motion.moves_backwards + motion.moves_same),
                   "the laser looks to the rear and the log does not say so: odometry pulls the wrong way",
                   "publish the mounting with yaw = pi in /tf_static"});
  }
  const bool explained =
      motion.turns_opposite > 4 * motion.turns_same || motion.moves_backwards > 4 * motion.moves_same;
  if (!explained && motion.compared >= 10 && percent(motion.disagree, motion.compared) > 25.0) {
    out.push_back({"odometry disagrees",
                   fmt::format("{:.0f} % of {} compared motions differ from what the scans show",
                               percent(motion.disagree, motion.compared), motion.compared),
                   "wheels slip, the ticks, the wheel base or the mounting of the laser are wrong, or stamps lag",
                   "calibrate by a turn on the spot and a straight line; or run with --odometry none"});
  }
  if (motion.neighbours >= 10 && percent(motion.fast, motion.neighbours) > 2.0) {
    out.push_back(
        {"too fast for its rate",
         fmt::format("{} of {} neighbouring scans are more than 20 deg or 0.5 m apart", motion.fast, motion.neighbours),
         "scans overlap less and each one is bent by the motion during its turn",
         "drive or turn slower, or run the sensor faster"});
  }
  if (motion.matched + motion.unmatched >= 20 && motion.unmatched > motion.matched) {
    out.push_back({"scans hard to match",
                   fmt::format("{} of {} pairs of near scans have no match to be trusted", motion.unmatched,
                               motion.matched + motion.unmatched),
                   "corridors, open space, people in front of the sensor, or beams at wrong angles",
                   "check the angles that the driver states; drive where more is to be seen"});
  }
}

}  // namespace

struct LogDoctor::Impl {
  std::map<std::string, Laser> lasers;
};

LogDoctor::LogDoctor() : impl_(std::make_unique<Impl>()) {}
LogDoctor::~LogDoctor() = default;

void LogDoctor::add(const LogEntry& entry) {
  constexpr std::size_t kMostLasers = 64;
  if (impl_->lasers.size() >= kMostLasers && !impl_->lasers.contains(entry.laser)) return;
  Laser& laser = impl_->lasers[entry.laser];
  count_scan(laser, entry.scan);
  laser.stamps.add(entry.scan.stamp);
  laser.motion.add(entry);
}

std::vector<Finding> LogDoctor::findings(const std::map<std::string, std::string>& facts) const {
  std::vector<Finding> out;
  if (const auto absurd = facts.find("time_increment absurd"); absurd != facts.end()) {
    out.push_back({"time_increment absurd", absurd->second,
                   "taking motion out of a scan would bend it: read as unknown",
                   "set time_increment to the scan time over the number of beams, or to 0"});
  }
  for (const auto& [name, laser] : impl_->lasers) {
    const std::size_t before = out.size();
    find_in_scans(laser, out);
    find_in_stamps(laser, out);
    find_in_motion(laser.motion.counts(), out);
    if (impl_->lasers.size() == 1) continue;
    for (std::size_t i = before; i < out.size(); ++i) out[i].seen = name + ": " + out[i].seen;
  }
  return out;
}

}  // namespace phasescan
